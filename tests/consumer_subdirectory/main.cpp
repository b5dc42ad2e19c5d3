// SPDX-License-Identifier: MIT
//
// A user who builds the library along with their own project.
#include <alcap/conventions.h>
#include <alcap/version.h>

#include <iostream>

int main() {
  std::cout << "alcap " << alcap::version() << ", wrap(7) = " << alcap::wrap(7.0) << "\n";
  return alcap::wrap(7.0) < 1.0 ? 0 : 1;
}
