/* SPDX-License-Identifier: MIT */
/**
 * @file
 * alcap_c.h: the C interface: opaque handles, plain arrays, error codes. For C99 and for everything that can call C.
 * alcap.h does not include it; link alcap::alcap_c (libalcap_c).
 *
 *     alcap_error error = ALCAP_ERROR_INIT;
 *     alcap_surface* surface = NULL;
 *     alcap_run* run = NULL;
 *     alcap_field_options options = ALCAP_FIELD_OPTIONS_INIT;
 *     options.n = 4;
 *     if (alcap_surface_create(V, vertices, F, faces, &surface, &error) != ALCAP_OK ||
 *         alcap_field_solve(surface, &options, &run, &error) != ALCAP_OK)
 *       puts(error.message);
 *     alcap_run_free(run);
 *     alcap_surface_free(surface);
 *
 * Arrays lie one row after the other; complex numbers are two doubles. Pointers that a handle gives out belong to it
 * and hold until it is freed. Handles share what they need: they may be freed in any order. NULL may be freed.
 *
 * Structs begin with their size, which the ..._INIT macros set: a program that was compiled with an older header works
 * with a newer library, which fills and reads what the program knows. Functions never throw; what failed is in the
 * status that they return and in `error`, which may be NULL. Signs, frames and units are those of conventions.h.
 *
 * Surfaces and runs never change and may be used by several threads at once; a designer by one at a time.
 */
#ifndef ALCAP_C_H
#define ALCAP_C_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** The version of this interface; it grows when something is added. */
#define ALCAP_C_VERSION 1

/** What a function returns. New ones may be added: treat what you do not know as a failure. */
typedef enum alcap_status {
  ALCAP_OK = 0,          /**< it worked */
  ALCAP_BAD_OPTION = 1,  /**< an argument has a value it must not have: alcap_error::field */
  ALCAP_BAD_MESH = 2,    /**< the mesh cannot be used: alcap_error::defect and the elements */
  ALCAP_BAD_FILE = 3,    /**< a file could not be read or written */
  ALCAP_SOLVE_ERROR = 4, /**< a solver could not do its work */
  ALCAP_CANCELLED = 5,   /**< the callback asked for it */
  ALCAP_NO_MEMORY = 6,   /**< memory ran out */
  ALCAP_INTERNAL = 7     /**< a bug in alcap */
} alcap_status;

/** What went wrong. Filled when a function does not return ALCAP_OK. */
typedef struct alcap_error {
  uint32_t size;       /**< sizeof(alcap_error) */
  int32_t status;      /**< an alcap_status */
  int64_t count;       /**< of a mesh: how many elements are concerned */
  int32_t first_count; /**< how many entries of `first` are set */
  int32_t first[16];   /**< the first of them: vertices or faces, or pairs of vertices for edges */
  char element[16];    /**< "vertex", "edge", "face" or empty */
  char defect[32];     /**< such as "non_manifold_edge", or empty */
  char field[64];      /**< of an option: which one */
  char message[1024];  /**< one sentence, cut where it is longer */
} alcap_error;
/** An alcap_error to begin with. */
#define ALCAP_ERROR_INIT                                              \
  {                                                                   \
    (uint32_t)sizeof(alcap_error), 0, 0, 0, {0}, {0}, {0}, {0}, { 0 } \
  }

/** A mesh ready to compute on. */
typedef struct alcap_surface alcap_surface;
/** A field with everything that was computed on the way. */
typedef struct alcap_run alcap_run;
/** A design that is prepared once and edited live. */
typedef struct alcap_designer alcap_designer;

/** The version of the library, "major.minor.patch". */
const char* alcap_version_string(void);
/** ALCAP_C_VERSION of the library. */
uint32_t alcap_c_version(void);

/* ---- surfaces */

/**
 * A surface from points V (3 * vertices numbers) and counter-clockwise triangles F (3 * faces vertices, from 0).
 * Copies. ALCAP_BAD_MESH names the elements of a mesh that cannot be used.
 */
alcap_status alcap_surface_create(const double* V, int64_t vertices, const int32_t* F, int64_t faces,
                                  alcap_surface** surface, alcap_error* error);
/** A surface from an OBJ, OFF, PLY or STL file. */
alcap_status alcap_surface_read(const char* path, alcap_surface** surface, alcap_error* error);
/** Frees a surface. */
void alcap_surface_free(alcap_surface* surface);
/** Number of vertices; 0 for NULL, here and below. */
int64_t alcap_surface_vertices(const alcap_surface* surface);
/** Number of faces. */
int64_t alcap_surface_faces(const alcap_surface* surface);
/** Euler characteristic. */
int64_t alcap_surface_euler(const alcap_surface* surface);
/** 3 * vertices numbers. */
const double* alcap_surface_V(const alcap_surface* surface);
/** 3 * faces vertices. */
const int32_t* alcap_surface_F(const alcap_surface* surface);

/* ---- fields */

/** How a connection is built, see ConnectionKind. */
typedef enum alcap_connection_kind {
  ALCAP_CONNECTION_GLOBAL = 0, /**< as Levi-Civita as possible */
  ALCAP_CONNECTION_LOCAL = 1,  /**< locally optimal */
  ALCAP_CONNECTION_POLAR = 2   /**< geodesic polar map */
} alcap_connection_kind;

/** What a long call computes, and how. Zeros stand for the defaults of the library. */
typedef struct alcap_field_options {
  uint32_t size;                                                    /**< sizeof(alcap_field_options) */
  int32_t n;                                                        /**< 1 vectors, 2 lines, 4 crosses */
  int32_t connection;                                               /**< an alcap_connection_kind */
  int32_t normalise;                                                /**< not 0: divide by |u| afterwards */
  int32_t threads;                                                  /**< the most threads; 0: all */
  int32_t max_iterations;                                           /**< of the eigensolver; 0: 1000 */
  double detail;                                                    /**< of the connection; 0: 1 */
  double s;                                                         /**< energy family in [-1, 1] */
  double tolerance;                                                 /**< relative residual; 0: 1e-8 */
  const char* solver;                                               /**< linear backend; NULL: the fastest */
  int (*cancel)(void* user);                                        /**< not 0 ends the call; may be NULL */
  void (*progress)(const char* phase, double fraction, void* user); /**< told of phases; may be NULL */
  void* user;                                                       /**< handed to both */
} alcap_field_options;
/** An alcap_field_options to begin with: a cross field. */
#define ALCAP_FIELD_OPTIONS_INIT \
  { (uint32_t)sizeof(alcap_field_options), 4, 0, 0, 0, 0, 0, 0, 0, NULL, NULL, NULL, NULL }

/**
 * The smoothest field of a surface. What did not converge is told by the certificate, not by the status. `options` may
 * be NULL. `cancel` is asked about every hundredth of a second, on any thread, one at a time.
 */
alcap_status alcap_field_solve(const alcap_surface* surface, const alcap_field_options* options, alcap_run** run,
                               alcap_error* error);
/**
 * The field that a design asks for: JSON as docs/design.md describes. Of `options` solver, normalise, threads,
 * tolerance, cancel and progress count; the rest is in the design.
 */
alcap_status alcap_design_solve(const alcap_surface* surface, const char* design, const alcap_field_options* options,
                                alcap_run** run, alcap_error* error);
/** Frees a run. */
void alcap_run_free(alcap_run* run);

/** A face of non-zero index. */
typedef struct alcap_singularity {
  int32_t face;          /**< the face it lies in */
  int32_t index;         /**< in n-ths of a turn */
  double barycentric[3]; /**< where the field vanishes in the face */
  double orientation;    /**< radians, in the face's frame */
} alcap_singularity;

/** What must hold for the result to be what it claims to be; each 1 or 0. */
typedef struct alcap_certificate {
  uint32_t size;                /**< sizeof(alcap_certificate) */
  int32_t holds;                /**< all of the below but controls_met */
  int32_t connection_converged; /**< the connection reached its tolerance */
  int32_t eigen_converged;      /**< every eigenproblem */
  int32_t residual_small;       /**< recomputed residuals */
  int32_t index_sums_match;     /**< Poincare-Hopf, on every component */
  int32_t finite;               /**< no value is NaN or infinite */
  int32_t controls_met;         /**< of a design; otherwise 1 */
} alcap_certificate;
/** An alcap_certificate to be filled. */
#define ALCAP_CERTIFICATE_INIT \
  { (uint32_t)sizeof(alcap_certificate), 0, 0, 0, 0, 0, 0, 0 }

/** Degree of the field. */
int32_t alcap_run_n(const alcap_run* run);
/** 2 * vertices numbers: real and imaginary parts of the n-th power of any branch, in vertex frames. */
const double* alcap_run_u(const alcap_run* run);
/** 3 * vertices numbers: the unit tangent axes of the vertex frames. */
const double* alcap_run_frames_X(const alcap_run* run);
/** 3 * vertices numbers: the unit normals of the vertex frames. */
const double* alcap_run_frames_N(const alcap_run* run);
/** Branch k, 0 <= k < n, as vectors in space: fills 3 * vertices numbers. */
alcap_status alcap_run_vectors(const alcap_run* run, int32_t k, double* vectors, alcap_error* error);
/** The index of every face, in n-ths: one number per face. */
const int32_t* alcap_run_indices(const alcap_run* run);
/** How many singularities. */
int64_t alcap_run_singularity_count(const alcap_run* run);
/** All singularities, in order of faces. */
const alcap_singularity* alcap_run_singularities(const alcap_run* run);
/** How many eigenpairs were solved for: one per component, none for variational designs. */
int64_t alcap_run_eigen_count(const alcap_run* run);
/** Smallest eigenvalue of a component; NaN when there is no such number. */
double alcap_run_lambda(const alcap_run* run, int64_t component);
/** Relative residual of that eigenpair, recomputed; NaN when there is no such number. */
double alcap_run_residual(const alcap_run* run, int64_t component);
/** Fills what `certificate->size` has room for. */
alcap_status alcap_run_certificate(const alcap_run* run, alcap_certificate* certificate, alcap_error* error);
/** The report of the command line as JSON, see docs/report.md; its "input" is null. */
const char* alcap_run_report(const alcap_run* run);
/** Writes the field in the format of the extension. The file appears complete or not at all. */
alcap_status alcap_run_write(const alcap_run* run, const char* path, alcap_error* error);

/* ---- live design */

/** What a control is. */
typedef enum alcap_control_kind {
  ALCAP_SINGULARITY = 0, /**< face, sign, orientation, strength, pinned, pin */
  ALCAP_VERTEX = 1,      /**< vertex, value, direction_only */
  ALCAP_STROKE = 2,      /**< vertices, vertex_count, weight, radius */
  ALCAP_BOUNDARY = 3     /**< normal, weight */
} alcap_control_kind;

/** A control; the members that its kind does not name are not read. */
typedef struct alcap_control {
  uint32_t size;           /**< sizeof(alcap_control) */
  int32_t kind;            /**< an alcap_control_kind */
  int32_t face;            /**< the face of a singularity */
  int32_t vertex;          /**< the vertex whose field is held */
  int32_t sign;            /**< +1 or -1: the index in n-ths */
  int32_t pinned;          /**< not 0: the zero lies at `pin` */
  int32_t direction_only;  /**< not 0: the length is free */
  int32_t normal;          /**< not 0: across the boundary */
  double orientation;      /**< radians, see SingularityTarget */
  double strength;         /**< 1 holds against a guidance field of unit length */
  double pin[3];           /**< barycentric coordinates in the face */
  double value[2];         /**< u at the vertex */
  double weight;           /**< larger follows closer */
  double radius;           /**< half the width of a stroke, in the unit of V */
  const int32_t* vertices; /**< of a stroke: joined by shortest paths of edges */
  int64_t vertex_count;    /**< how many */
} alcap_control;
/** An alcap_control to begin with: strength and weight 1, a positive singularity. */
#define ALCAP_CONTROL_INIT \
  { (uint32_t)sizeof(alcap_control), 0, -1, -1, 1, 0, 0, 0, 0, 1, {0, 0, 0}, {1, 0}, 1, 0, NULL, 0 }

/** What became of a control. */
typedef struct alcap_control_report {
  int32_t id;           /**< which control */
  int32_t met;          /**< 1 or 0 */
  int32_t index;        /**< of a singularity: found in the face, in n-ths */
  int32_t reserved;     /**< 0 */
  double error_degrees; /**< of a singularity its orientation, of others the direction */
} alcap_control_report;

/**
 * Prepares designs on a surface. Of `options` n, connection, detail, s, solver, threads, cancel and progress count, and
 * are used by every call. `guidance_weight` as of DesignerOptions: 0 where nothing but the controls counts.
 */
alcap_status alcap_designer_create(const alcap_surface* surface, const alcap_field_options* options,
                                   double guidance_weight, alcap_designer** designer, alcap_error* error);
/** Frees a designer. */
void alcap_designer_free(alcap_designer* designer);
/** Adds a control; `id` receives its name. */
alcap_status alcap_designer_add(alcap_designer* designer, const alcap_control* control, int32_t* id,
                                alcap_error* error);
/** Replaces a control. */
alcap_status alcap_designer_set(alcap_designer* designer, int32_t id, const alcap_control* control, alcap_error* error);
/** Removes a control. */
alcap_status alcap_designer_remove(alcap_designer* designer, int32_t id, alcap_error* error);
/** The field to stay close to, 2 * vertices numbers; needs a guidance weight. */
alcap_status alcap_designer_guidance(alcap_designer* designer, const double* u0, alcap_error* error);
/** Solves, and fills u (2 * vertices numbers). */
alcap_status alcap_designer_solve(alcap_designer* designer, double* u, alcap_error* error);
/** How many controls the last solve reported on. */
int64_t alcap_designer_report_count(const alcap_designer* designer);
/** Those reports, in the order of ids; they hold until the next call. */
const alcap_control_report* alcap_designer_reports(const alcap_designer* designer);

#ifdef __cplusplus
}
#endif

#endif
