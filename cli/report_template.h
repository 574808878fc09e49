/* The page that reports are made from, as the build carries it into the program (cmake/embed.cmake). */
#ifndef LAVES_CLI_REPORT_TEMPLATE_H
#define LAVES_CLI_REPORT_TEMPLATE_H

/* The bytes of cli/report_template.html, and a zero. */
extern const unsigned char report_template[];

#endif
