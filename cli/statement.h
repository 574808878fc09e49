/* The statement on a mesh in words and in the JSON of a run: what its certificate says. */
#ifndef LAVES_CLI_STATEMENT_H
#define LAVES_CLI_STATEMENT_H

#include "session.h"

/* Tiles, distances, promise, features, and one line for each kind of exception.
 * @param lists  the caller lists tets outside the asked window, distant places and features itself */
void statement_say(const laves_certificate *certificate, bool lists);

/* The members that a statement adds to those of a checked mesh. */
void statement_write_json(json *out, const laves_certificate *certificate);

/* Certifies a mesh that this command made: the certificate names the command, without its job file. */
laves_result statement_make(session *run, const laves_mesh *mesh, laves_certify_options *options, laves_certificate *certificate);

#endif
