// SPDX-License-Identifier: MIT
//
// Any design on any small mesh, solved from nothing and as an edit of another one: a field that its certificate
// describes, an outcome per control, or one of the library's exceptions.
#include "alcap/design_run.h"
#include "alcap/errors.h"
#include "fuzz/input.h"

namespace {

using namespace alcap;

/// An element, now and then one that is not there.
Index element(fuzz::Bytes& in, Eigen::Index count) { return static_cast<Index>(in.below(static_cast<int>(count) + 1)); }

void add_control(fuzz::Bytes& in, const MeshData& m, DesignFile& design) {
  switch (in.below(4)) {
    case 0: {
      DesignSingularity s{.face = element(in, m.F.rows())};
      s.kind = static_cast<SingularityKind>(in.below(7));
      s.angle = 180 * in.real();
      s.count = 1 + in.below(3);
      s.pin = in.below(3) == 0;
      s.strength = in.scale(3);
      design.singularities.push_back(s);
      break;
    }
    case 1: {
      DesignFixed f{.vertex = element(in, m.V.rows())};
      f.direction = Vector3{in.real(), in.real(), in.real()};
      f.length = in.scale(3);
      f.free_length = in.below(2) == 0;
      design.fixed.push_back(f);
      break;
    }
    case 2: {
      DesignStroke s;
      for (int k = 2 + in.below(3); k > 0; --k) s.vertices.push_back(element(in, m.V.rows()));
      s.weight = in.scale(3);
      s.radius = in.below(3) == 0 ? in.scale(1) : 0;
      design.strokes.push_back(s);
      break;
    }
    default:
      design.connection.cones.push_back({element(in, m.V.rows()), double(in.below(9) - 4) / design.n});
      break;
  }
}

void add_feature_options(fuzz::Bytes& in, const MeshData& m, DesignFeatures& features) {
  features.hold = in.below(2) == 0;
  features.across = in.below(3) == 0;
  features.boundary = in.below(2) == 0;
  features.corner_angle = 90 + 89 * in.real();
  features.low_angle = in.below(3) == 0 ? features.angle / 2 : 0;
  features.gap = in.below(3) == 0 ? in.scale(2) : 0;
  features.spur = in.below(3) == 0 ? in.scale(2) : 0;
  if (in.below(4) != 0) return;
  for (int k = 1 + in.below(4); k > 0; --k) {
    const Eigen::Index t = in.below(static_cast<int>(m.F.rows()));
    features.edges.push_back({m.F(t, 0), m.F(t, 1)});
  }
}

DesignFile any_design(fuzz::Bytes& in, const MeshData& m) {
  DesignFile design;
  design.n = 1 + in.below(6);
  design.s = in.below(3) == 0 ? in.real() : 0;
  design.method = in.below(3) == 0 ? DesignMethod::eigen : DesignMethod::variational;
  design.connection.kind = std::array{ConnectionKind::global, ConnectionKind::local, ConnectionKind::polar,
                                      ConnectionKind::trivial}[static_cast<std::size_t>(in.below(4))];
  design.connection.balance = in.below(2) == 0;
  design.guidance.source = static_cast<DesignGuidance::Source>(in.below(4));
  design.guidance.weight = in.scale(3);
  design.boundary = {.wanted = in.below(3) == 0, .normal = in.below(2) == 0, .weight = in.scale(2)};
  design.features = {.wanted = in.below(4) == 0, .angle = 90 + 89 * in.real()};
  for (int k = in.below(5); k > 0; --k) add_control(in, m, design);
  if (design.features.wanted) add_feature_options(in, m, design.features);
  return design;
}

void check(const DesignRun& run) {
  fuzz::demand(run.field.u.size() == run.mesh().vertices(), "a value per vertex");
  fuzz::demand(run.field.u.allFinite() == run.certificate.finite, "finite is finite");
  for (const Singularity& s : run.singularities)
    fuzz::demand(s.face >= 0 && s.face < run.mesh().faces() && s.index != 0, "singularities lie in faces");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Bytes in(data, size);
  const MeshData m = fuzz::small_mesh(in);
  try {
    const Surface surface(m.V, m.F);
    DesignSession session(surface);
    DesignFile design = any_design(in, m);
    for (int edit = in.below(3); edit >= 0; --edit) {
      try {
        check(session.solve(design));
      } catch (const Error&) {
      }
      add_control(in, m, design);
    }
  } catch (const Error&) {
  }
  return 0;
}
