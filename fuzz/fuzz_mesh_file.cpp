// SPDX-License-Identifier: MIT
//
// Any bytes are a mesh whose faces name its vertices, or a FileError; and all that is asked of a mesh can be answered.
#include "alcap/errors.h"
#include "alcap/mesh_check.h"
#include "alcap/mesh_io.h"
#include "fuzz/input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace alcap;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  for (const char* format : {"", "obj", "off", "ply", "stl"}) {
    try {
      const MeshFile m = read_mesh_from_memory(bytes, format);
      fuzz::demand(m.V.rows() > 0 && m.F.rows() > 0, "a mesh has vertices and faces");
      fuzz::demand(m.V.allFinite(), "positions are finite");
      fuzz::demand(m.F.minCoeff() >= 0 && m.F.maxCoeff() < m.V.rows(), "faces name vertices");
      fuzz::demand(m.polygon_of.empty() || static_cast<Eigen::Index>(m.polygon_of.size()) == m.F.rows(),
                   "triangles know their polygons");
      (void)find_defects(m.F, m.V.rows());
      (void)find_defects(m.V, m.F);
    } catch (const FileError&) {
    }
  }
  return 0;
}
