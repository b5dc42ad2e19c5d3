// SPDX-License-Identifier: MIT
//
// holonomy.cpp: the turn of a vector carried around a strip of faces.
#include <string>

#include "alcap/connection.h"

namespace alcap {

double holonomy(const Mesh& mesh, const Geometry& geometry, const Connection& connection, const Loop& strip) {
  double sum = 0;
  for (const Index h : strip.halfedges) {
    const Index g = mesh.twin(h);
    if (g == none) throw OptionError("strip", h, "this halfedge lies on the boundary and cannot be crossed");
    sum += pi<double> + connection.edge_to_face(geometry, h) - connection.edge_to_face(geometry, g);
  }
  return wrap(sum);
}

}  // namespace alcap
