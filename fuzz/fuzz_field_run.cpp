// SPDX-License-Identifier: MIT
//
// A whole run on any small mesh with any options ends with a field that its certificate describes, or with one of the
// library's exceptions.
#include "alcap/errors.h"
#include "alcap/field_run.h"
#include "fuzz/input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace alcap;
  fuzz::Bytes in(data, size);
  const MeshData m = fuzz::small_mesh(in);
  FieldRunOptions options;
  options.n = 1 + in.below(8);
  options.s = in.real();
  options.connection.kind = std::array{ConnectionKind::polar, ConnectionKind::local, ConnectionKind::global,
                                       ConnectionKind::trivial}[static_cast<std::size_t>(in.below(4))];
  options.connection.balance_cones = options.connection.kind == ConnectionKind::trivial;
  options.connection.global.detail = in.scale(2);
  options.repairs = in.below(2) == 0 ? std::vector<Repair>{} : std::vector{Repair::weld, Repair::orient};
  try {
    const FieldRun run = run_field(m.V, m.F, options);
    fuzz::demand(run.field.u.size() == run.mesh().vertices(), "a value per vertex");
    if (run.certificate.finite) fuzz::demand(run.field.u.allFinite(), "finite is finite");
    for (const Singularity& s : run.singularities)
      fuzz::demand(s.face >= 0 && s.face < run.mesh().faces() && s.index != 0, "singularities lie in faces");
  } catch (const Error&) {
  }
  return 0;
}
