// SPDX-License-Identifier: MIT
//
// alcap.h: all public headers at once.
#pragma once

// IWYU pragma: begin_exports
#include "alcap/alignment.h"
#include "alcap/assembly.h"
#include "alcap/batch.h"
#include "alcap/cones.h"
#include "alcap/connection.h"
#include "alcap/controls.h"
#include "alcap/conventions.h"
#include "alcap/design_file.h"
#include "alcap/designer.h"
#include "alcap/eigen_design.h"
#include "alcap/energies.h"
#include "alcap/errors.h"
#include "alcap/field.h"
#include "alcap/field_run.h"
#include "alcap/frames.h"
#include "alcap/generators.h"
#include "alcap/geometry.h"
#include "alcap/memory.h"
#include "alcap/mesh.h"
#include "alcap/mesh_check.h"
#include "alcap/mesh_io.h"
#include "alcap/operators.h"
#include "alcap/output.h"
#include "alcap/singularities.h"
#include "alcap/smoothest.h"
#include "alcap/solve.h"
#include "alcap/streamlines.h"
#include "alcap/strokes.h"
#include "alcap/topology.h"
#include "alcap/version.h"
// IWYU pragma: end_exports
