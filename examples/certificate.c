// States what a mesh is, writes the statement beside it, and sees that a mesh that was changed no longer fits.
#include <laves/laves.h>
#include <stdio.h>

int main(void) {
  const char *solid = "sphere(1) - cylinder{r=0.4}";
  laves_context *context = laves_context_create(NULL);
  if (!context) return 4;

  laves_error error;
  laves_domain *domain = NULL;
  laves_mesh *mesh = NULL, *changed = NULL;
  laves_report report;
  laves_certificate made, read;
  laves_options options = laves_options_default();
  options.size = 0.15;
  laves_result result = laves_domain_from_expression(context, solid, &domain, &error);
  if (result == LAVES_OK) result = laves_generate(context, domain, &options, &mesh, &report, &error);

  laves_certify_options asked = laves_certify_options_default();
  asked.domain = domain;
  asked.input = solid;
  asked.options = &options;
  asked.report = &report;
  if (result == LAVES_OK) result = laves_certify(context, mesh, &asked, &made, &error);
  if (result == LAVES_OK) result = laves_certificate_write(context, &made, "bead.certificate.json", &error);
  if (result == LAVES_OK) result = laves_certificate_read(context, "bead.certificate.json", &read, &error);
  if (result == LAVES_OK) {
    printf("%zu tets, %zu of them exact tiles, angles %.2f .. %.2f\n", read.check.tets, read.lattice_tets,
           read.attained_min_dihedral, read.attained_max_dihedral);
  }

  // All tets but the last one: another mesh.
  laves_difference differences[3];
  size_t count = 0;
  if (result == LAVES_OK) {
    result = laves_mesh_from_arrays(context, laves_mesh_points(mesh), laves_mesh_vertex_count(mesh), laves_mesh_tets(mesh),
                                    laves_mesh_tet_count(mesh) - 1, NULL, &changed, &error);
  }
  if (result == LAVES_OK) {
    result = laves_certificate_verify(context, changed, domain, solid, &read, differences, 3, &count, &error);
  }
  printf("%zu figures are not so, such as\n", count);
  for (size_t i = 0; i < count && i < 3; i++) printf("  %s\n", differences[i].text);

  if (result != LAVES_OK) fprintf(stderr, "%s\n", error.text);
  laves_mesh_free(changed);
  laves_mesh_free(mesh);
  laves_domain_free(domain);
  laves_context_free(context);
  return result == LAVES_OK && count > 0 ? 0 : 1;
}
