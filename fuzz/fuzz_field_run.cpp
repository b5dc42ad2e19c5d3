// SPDX-License-Identifier: MIT
//
// A whole run on any small mesh with any options ends with a field that its certificate describes, or with one of the
// library's exceptions.
#include "alcap/errors.h"
#include "alcap/field_run.h"
#include "fuzz/input.h"

namespace {

using namespace alcap;

FieldAlignment any_alignment(fuzz::Bytes& in, const MeshData& m) {
  FieldAlignment align;
  align.features.angle = (0.5 + 0.499 * in.real()) * pi<double>;
  align.features.boundary = in.below(2) == 0;
  align.features.low_angle = in.below(2) == 0 ? 0 : align.features.angle / 2;
  align.features.gap = in.below(2) == 0 ? 0 : in.scale(2);
  align.features.spur = in.below(2) == 0 ? 0 : in.scale(2);
  for (int k = in.below(4); k > 0; --k) {
    // An edge of the mesh or, now and then, a pair that is none.
    const Eigen::Index t = in.below(static_cast<int>(m.F.rows()));
    align.edges.push_back({m.F(t, 0), in.below(8) == 0 ? in.below(static_cast<int>(m.V.rows()) + 1) : m.F(t, 1)});
  }
  align.across = in.below(2) == 0;
  align.weight = in.below(2) == 0 ? 0 : in.scale(3);
  align.max_steps = in.below(2) == 0 ? AlignedOptions{}.max_steps : in.below(4);
  return align;
}

FieldRunOptions any_options(fuzz::Bytes& in) {
  FieldRunOptions options;
  options.n = 1 + in.below(8);
  options.s = in.real();
  options.connection.kind = std::array{ConnectionKind::polar, ConnectionKind::local, ConnectionKind::global,
                                       ConnectionKind::trivial}[static_cast<std::size_t>(in.below(4))];
  options.connection.balance_cones = options.connection.kind == ConnectionKind::trivial;
  options.connection.global.detail = in.scale(2);
  options.repairs = in.below(2) == 0 ? std::vector<Repair>{} : std::vector{Repair::weld, Repair::orient};
  return options;
}

// Read behind everything else, so that the inputs of the corpus keep their meaning.
void add_more(fuzz::Bytes& in, const MeshData& m, FieldRunOptions& options) {
  options.triangulation = static_cast<Triangulation>(in.below(3));
  if (in.below(3) == 1) options.min_angle = in.below(31) * pi<double> / 180;
  if (in.below(4) == 1) options.modes = 1 + in.below(4);
  if (in.below(4) == 1) options.repairs.push_back(Repair::mollify);
  options.normalise = in.below(4) == 1;
  if (in.below(4) == 1) {
    options.connection.kind = ConnectionKind::metric;
    options.connection.balance_cones = false;
    // Cones that sum to what the surface demands, except on surfaces of several pieces.
    double rest = static_cast<double>(Surface(m.V, m.F).topology().euler());
    for (int k = in.below(4); k >= 0; --k) {
      const double index = k == 0 ? rest : 2 * in.real();
      options.connection.cones.push_back({in.below(static_cast<int>(m.V.rows()) + 1), index});
      rest -= index;
    }
  }
  if (in.below(3) != 1) return;
  options.align = any_alignment(in, m);
  // The energy and the number of fields that alignment takes; others now and then, to be refused.
  if (in.below(8) != 1) options.s = 0;
  if (in.below(8) != 1) options.modes = 1;
  if (in.below(8) != 1) options.n += options.n % 2;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Bytes in(data, size);
  const MeshData m = fuzz::small_mesh(in);
  FieldRunOptions options = any_options(in);
  try {
    add_more(in, m, options);
    const FieldRun run = run_field(m.V, m.F, options);
    fuzz::demand(run.field.u.size() == run.mesh().vertices(), "a value per vertex");
    if (run.certificate.finite) fuzz::demand(run.field.u.allFinite(), "finite is finite");
    for (const Singularity& s : run.singularities)
      fuzz::demand(s.face >= 0 && s.face < run.mesh().faces() && s.index != 0, "singularities lie in faces");
    fuzz::demand(run.modes.U.cols() == (options.modes > 1 ? options.modes : 0), "as many modes as asked for");
  } catch (const Error&) {
  }
  return 0;
}
