/* SPDX-License-Identifier: MIT */
/* test_c.c FILE.ply: the C interface from C99: a torus, whose every fact is known. */
#include <alcap/alcap_c.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int failures = 0;

#define CHECK(condition)                                              \
  do {                                                                \
    if (!(condition)) {                                               \
      printf("%s:%d: %s\n", __FILE__, __LINE__, #condition);          \
      ++failures;                                                     \
    }                                                                 \
  } while (0)

enum { NU = 24, NV = 12, VERTICES = NU * NV, FACES = 2 * NU * NV };

static double V[3 * VERTICES];
static int32_t F[3 * FACES];

static void make_torus(void) {
  const double turn = 6.283185307179586;
  int i, j, t = 0;
  for (i = 0; i < NU; ++i) {
    for (j = 0; j < NV; ++j) {
      const int next_i = (i + 1) % NU, next_j = (j + 1) % NV;
      const int a = i * NV + j, b = next_i * NV + j, c = next_i * NV + next_j, d = i * NV + next_j;
      const double r = 1 + 0.4 * cos(turn * j / NV);
      const int quad[6] = {a, b, c, a, c, d};
      V[3 * a] = r * cos(turn * i / NU);
      V[3 * a + 1] = r * sin(turn * i / NU);
      V[3 * a + 2] = 0.4 * sin(turn * j / NV);
      for (t = 0; t < 6; ++t) F[6 * a + t] = quad[t];
    }
  }
}

static void test_surface(void) {
  alcap_error error = ALCAP_ERROR_INIT;
  alcap_surface* surface = NULL;
  int32_t broken[3] = {0, 1, VERTICES};
  CHECK(alcap_surface_create(V, VERTICES, F, FACES, &surface, &error) == ALCAP_OK);
  CHECK(alcap_surface_vertices(surface) == VERTICES && alcap_surface_faces(surface) == FACES);
  CHECK(alcap_surface_euler(surface) == 0);
  CHECK(memcmp(alcap_surface_V(surface), V, sizeof V) == 0 && memcmp(alcap_surface_F(surface), F, sizeof F) == 0);
  alcap_surface_free(surface);

  surface = (alcap_surface*)&error;
  CHECK(alcap_surface_create(V, VERTICES, broken, 1, &surface, &error) == ALCAP_BAD_MESH);
  CHECK(surface == NULL && error.status == ALCAP_BAD_MESH && error.count == 1);
  CHECK(strcmp(error.defect, "index_out_of_range") == 0 && strcmp(error.element, "face") == 0);
  CHECK(error.first_count == 1 && error.first[0] == 0 && strlen(error.message) > 10);
  CHECK(alcap_surface_create(NULL, 3, broken, 1, &surface, NULL) == ALCAP_BAD_OPTION);
  CHECK(alcap_surface_create(V, -1, broken, 1, &surface, NULL) == ALCAP_BAD_OPTION);
  CHECK(alcap_surface_create(V, VERTICES, F, INT64_MAX, &surface, NULL) == ALCAP_BAD_OPTION);
  CHECK(alcap_surface_create(V, VERTICES, F, INT32_MAX, &surface, &error) == ALCAP_BAD_OPTION);
  CHECK(strcmp(error.field, "F") == 0 && strstr(error.message, "2147483647 rows") != NULL);
  CHECK(alcap_surface_create(V, 0, F, 0, &surface, NULL) == ALCAP_BAD_MESH);
  CHECK(alcap_surface_create(V, VERTICES, F, FACES, NULL, &error) == ALCAP_BAD_OPTION);
  CHECK(strcmp(error.field, "surface") == 0);
  CHECK(alcap_surface_read("/nowhere/mesh.obj", &surface, &error) == ALCAP_BAD_FILE);
  CHECK(strstr(error.message, "/nowhere/mesh.obj") != NULL);
}

static void check_field(const alcap_run* run) {
  const double *u = alcap_run_u(run), *N = alcap_run_frames_N(run), *X = alcap_run_frames_X(run);
  double* first = malloc(sizeof V);
  double* second = malloc(sizeof V);
  int64_t sum = 0, listed = 0, k;
  int v;
  alcap_certificate certificate = ALCAP_CERTIFICATE_INIT;
  CHECK(alcap_run_vectors(run, 0, first, NULL) == ALCAP_OK && alcap_run_vectors(run, 1, second, NULL) == ALCAP_OK);
  CHECK(alcap_run_vectors(run, 4, first, NULL) == ALCAP_BAD_OPTION);
  for (v = 0; v < VERTICES; ++v) {
    const double *a = first + 3 * v, *b = second + 3 * v, *n = N + 3 * v;
    const double length = sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
    CHECK(fabs(a[0] * n[0] + a[1] * n[1] + a[2] * n[2]) < 1e-12);       /* tangent */
    CHECK(fabs(a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) < 1e-12);       /* a cross */
    CHECK(fabs(pow(length, 4) - hypot(u[2 * v], u[2 * v + 1])) < 1e-9); /* u is the fourth power */
    CHECK(fabs(X[3 * v] * n[0] + X[3 * v + 1] * n[1] + X[3 * v + 2] * n[2]) < 1e-12);
  }
  for (k = 0; k < FACES; ++k) sum += alcap_run_indices(run)[k];
  for (k = 0; k < alcap_run_singularity_count(run); ++k) listed += alcap_run_singularities(run)[k].index;
  CHECK(sum == 0 && listed == 0); /* 4 times the Euler characteristic */
  CHECK(alcap_run_certificate(run, &certificate, NULL) == ALCAP_OK && certificate.holds == 1);
  CHECK(certificate.index_sums_match == 1 && certificate.finite == 1 && certificate.controls_met == 1);
  CHECK(alcap_run_n(run) == 4 && alcap_run_eigen_count(run) == 1);
  CHECK(alcap_run_lambda(run, 0) > 0 && alcap_run_residual(run, 0) <= 1e-8);
  CHECK(isnan(alcap_run_lambda(run, 1)) && isnan(alcap_run_lambda(run, -1)));
  CHECK(strstr(alcap_run_report(run), "\"certificate\"") != NULL);
  free(first);
  free(second);
}

static int stop_at_once(void* user) {
  ++*(int*)user;
  return 1;
}
static void count_phase(const char* phase, double fraction, void* user) {
  CHECK(strlen(phase) > 0 && fraction >= 0 && fraction <= 1);
  ++*(int*)user;
}

static void test_field(const char* file) {
  alcap_error error = ALCAP_ERROR_INIT;
  alcap_surface *surface = NULL, *back = NULL;
  alcap_run* run = NULL;
  alcap_field_options options = ALCAP_FIELD_OPTIONS_INIT;
  int calls = 0;
  CHECK(alcap_surface_create(V, VERTICES, F, FACES, &surface, &error) == ALCAP_OK);
  options.progress = &count_phase;
  options.user = &calls;
  CHECK(alcap_field_solve(surface, &options, &run, &error) == ALCAP_OK && calls >= 3);
  CHECK(alcap_run_write(run, file, &error) == ALCAP_OK);
  CHECK(alcap_run_write(run, "/nowhere/field.ply", &error) == ALCAP_BAD_FILE);
  CHECK(alcap_surface_read(file, &back, &error) == ALCAP_OK && alcap_surface_faces(back) == FACES);
  alcap_surface_free(back);

  calls = 0;
  options.progress = NULL;
  options.cancel = &stop_at_once;
  {
    alcap_run* none = NULL;
    CHECK(alcap_field_solve(surface, &options, &none, &error) == ALCAP_CANCELLED && none == NULL && calls >= 1);
    options.cancel = NULL;
    options.n = 0;
    CHECK(alcap_field_solve(surface, &options, &none, &error) == ALCAP_BAD_OPTION && strcmp(error.field, "n") == 0);
    options.n = 4;
    options.solver = "no such";
    CHECK(alcap_field_solve(surface, &options, &none, NULL) == ALCAP_BAD_OPTION && none == NULL);
    options.solver = NULL;
    options.connection = 17;
    CHECK(alcap_field_solve(surface, &options, &none, &error) == ALCAP_BAD_OPTION);
  }
  alcap_surface_free(surface); /* the run keeps what it needs */
  check_field(run);
  alcap_run_free(run);
}

/* Programs that were compiled with a shorter struct. */
static void test_versions(void) {
  struct {
    alcap_error error;
    char after[16];
  } old = {ALCAP_ERROR_INIT, "untouched"};
  alcap_certificate certificate = ALCAP_CERTIFICATE_INIT;
  alcap_field_options options = ALCAP_FIELD_OPTIONS_INIT;
  alcap_surface* surface = NULL;
  alcap_run* run = NULL;
  memset(old.error.message, 'x', sizeof old.error.message);
  old.error.size = offsetof(alcap_error, message);
  CHECK(alcap_surface_create(V, -1, F, 1, &surface, &old.error) == ALCAP_BAD_OPTION);
  CHECK(old.error.status == ALCAP_BAD_OPTION && strcmp(old.error.field, "vertices") == 0);
  CHECK(old.error.message[0] == 'x' && strcmp(old.after, "untouched") == 0);
  CHECK(old.error.size == offsetof(alcap_error, message));

  CHECK(alcap_surface_create(V, VERTICES, F, FACES, &surface, NULL) == ALCAP_OK);
  options.size = offsetof(alcap_field_options, tolerance);
  options.n = 1;
  options.solver = (const char*)1; /* beyond its end: not read */
  CHECK(alcap_field_solve(surface, &options, &run, NULL) == ALCAP_OK && alcap_run_n(run) == 1);
  certificate.size = offsetof(alcap_certificate, eigen_converged);
  certificate.eigen_converged = 42;
  CHECK(alcap_run_certificate(run, &certificate, NULL) == ALCAP_OK);
  CHECK(certificate.holds == 1 && certificate.eigen_converged == 42);
  certificate.size = 0;
  CHECK(alcap_run_certificate(run, &certificate, NULL) == ALCAP_BAD_OPTION);
  alcap_run_free(run);
  alcap_surface_free(surface);
}

static void test_design(void) {
  static const char design[] =
      "{\"alcap_design\": 1, \"n\": 1, \"singularities\": [{\"face\": 40, \"kind\": \"saddle\", \"angle\": 20}],"
      " \"guidance\": {\"field\": \"zero\", \"weight\": 0.1}}";
  alcap_error error = ALCAP_ERROR_INIT;
  alcap_surface* surface = NULL;
  alcap_run* run = NULL;
  CHECK(alcap_surface_create(V, VERTICES, F, FACES, &surface, &error) == ALCAP_OK);
  CHECK(alcap_design_solve(surface, design, NULL, &run, &error) == ALCAP_OK);
  CHECK(alcap_run_indices(run)[40] == -1 && alcap_run_n(run) == 1);
  CHECK(strstr(alcap_run_report(run), "\"controls\"") != NULL);
  alcap_run_free(run);
  CHECK(alcap_design_solve(surface, "{", NULL, &run, &error) == ALCAP_BAD_FILE && run == NULL);
  alcap_surface_free(surface);
}

static void test_designer(void) {
  alcap_error error = ALCAP_ERROR_INIT;
  alcap_surface* surface = NULL;
  alcap_designer* designer = NULL;
  alcap_field_options options = ALCAP_FIELD_OPTIONS_INIT;
  alcap_control saddle = ALCAP_CONTROL_INIT, vertex = ALCAP_CONTROL_INIT, stroke = ALCAP_CONTROL_INIT;
  const int32_t path[2] = {0, NV};
  double* u = malloc(2 * VERTICES * sizeof *u);
  int32_t id = -1, other = -1;
  int step;
  options.n = 1;
  CHECK(alcap_surface_create(V, VERTICES, F, FACES, &surface, &error) == ALCAP_OK);
  CHECK(alcap_designer_create(surface, &options, 0.1, &designer, &error) == ALCAP_OK);
  alcap_surface_free(surface);
  saddle.face = 70;
  saddle.sign = -1;
  CHECK(alcap_designer_add(designer, &saddle, &id, &error) == ALCAP_OK);
  for (step = 0; step < 3; ++step) {
    saddle.orientation = 0.3 * step;
    CHECK(alcap_designer_set(designer, id, &saddle, &error) == ALCAP_OK);
    CHECK(alcap_designer_solve(designer, u, &error) == ALCAP_OK);
    CHECK(alcap_designer_report_count(designer) == 1 && alcap_designer_reports(designer)[0].id == id);
    CHECK(alcap_designer_reports(designer)[0].index == -1);
  }
  vertex.kind = ALCAP_VERTEX;
  vertex.vertex = 5;
  vertex.value[0] = 0.25;
  vertex.value[1] = -0.5;
  CHECK(alcap_designer_add(designer, &vertex, &other, &error) == ALCAP_OK && other != id);
  stroke.kind = ALCAP_STROKE;
  stroke.vertices = path;
  stroke.vertex_count = 2;
  CHECK(alcap_designer_add(designer, &stroke, &other, &error) == ALCAP_OK);
  stroke.vertex_count = 1;
  CHECK(alcap_designer_add(designer, &stroke, &id, &error) == ALCAP_BAD_OPTION);
  CHECK(strcmp(error.field, "vertex_count") == 0 && strstr(error.message, "at least 2") != NULL);
  CHECK(alcap_designer_remove(designer, id, &error) == ALCAP_OK);
  CHECK(alcap_designer_solve(designer, u, &error) == ALCAP_OK && alcap_designer_report_count(designer) == 2);
  CHECK(fabs(u[10] - 0.25) < 1e-8 && fabs(u[11] + 0.5) < 1e-8);
  CHECK(alcap_designer_remove(designer, id, &error) == ALCAP_BAD_OPTION);
  saddle.face = FACES;
  CHECK(alcap_designer_add(designer, &saddle, &id, &error) == ALCAP_BAD_OPTION && strlen(error.message) > 0);
  saddle.kind = 99;
  CHECK(alcap_designer_add(designer, &saddle, &id, &error) == ALCAP_BAD_OPTION);
  CHECK(alcap_designer_guidance(designer, u, &error) == ALCAP_OK);
  CHECK(alcap_designer_solve(designer, u, &error) == ALCAP_OK);
  alcap_designer_free(designer);
  free(u);
}

static void test_null(void) {
  CHECK(alcap_surface_vertices(NULL) == 0 && alcap_run_u(NULL) == NULL && alcap_run_report(NULL) == NULL);
  CHECK(alcap_designer_solve(NULL, NULL, NULL) == ALCAP_BAD_OPTION);
  CHECK(alcap_field_solve(NULL, NULL, NULL, NULL) == ALCAP_BAD_OPTION);
  alcap_surface_free(NULL);
  alcap_run_free(NULL);
  alcap_designer_free(NULL);
}

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  make_torus();
  CHECK(alcap_c_version() == ALCAP_C_VERSION && strlen(alcap_version_string()) >= 5);
  test_surface();
  test_field(argv[1]);
  test_versions();
  test_design();
  test_designer();
  test_null();
  printf("alcap %s, %d failures\n", alcap_version_string(), failures);
  return failures == 0 ? 0 : 1;
}
