// SPDX-License-Identifier: MIT
//
// A user of the library, installed or embedded: the smoothest cross field on a small mesh of their own.
#include <alcap/alcap.h>

#include <iostream>

int main() {
  alcap::Positions<double> V(4, 3);
  V << 1, 1, 1, 1, -1, -1, -1, 1, -1, -1, -1, 1;
  alcap::Faces F(4, 3);
  F << 0, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 2;
  const alcap::FieldRun run = alcap::run_field(V, F, {.n = 4});
  std::cout << "alcap " << alcap::version() << ": " << run.singularities.size() << " singularities, lambda "
            << run.eigen.at(0).lambda << "\n";
  return run.certificate.holds() && run.index_sums.at(0).sum == 4 * 2 ? 0 : 1;  // n times the Euler characteristic
}
