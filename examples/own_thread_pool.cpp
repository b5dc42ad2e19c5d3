// SPDX-License-Identifier: MIT
// Many small meshes on your own threads: one alcap::Context per thread computes only on that thread.
#include <alcap/alcap.h>

#include <atomic>
#include <iostream>
#include <thread>
#include <vector>

int main() {
  std::vector<alcap::MeshData> meshes;
  for (int i = 0; i < 8; ++i) meshes.push_back(alcap::torus(30 + 2 * i, 20, 1, 0.4));
  std::vector<double> lambda(meshes.size());
  std::atomic<std::size_t> next = 0, certified = 0;

  const auto work = [&] {
    alcap::Context context({.n = 4});
    for (std::size_t i = next++; i < meshes.size(); i = next++) {
      const alcap::FieldRun& run = context.run(meshes[i].V, meshes[i].F);  // kept until the next call
      lambda[i] = run.eigen[0].lambda;
      if (run.certificate.holds()) ++certified;
    }
  };
  std::vector<std::thread> pool;
  for (int t = 0; t < 4; ++t) pool.emplace_back(work);
  for (std::thread& thread : pool) thread.join();

  // A context gives the same result as run_field(), to the last bit.
  bool same = true;
  for (std::size_t i = 0; i < meshes.size(); ++i)
    same = same && lambda[i] == alcap::run_field(meshes[i].V, meshes[i].F, {.n = 4, .threads = 1}).eigen[0].lambda;
  std::cout << certified << " of " << meshes.size() << " meshes certified\n"
            << "the same as one after the other: " << (same ? "yes" : "no") << "\n";
}
