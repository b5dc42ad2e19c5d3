// SPDX-License-Identifier: MIT
//
// plan.cpp: the constants of src/run/plan.cpp: for every phase of run_field() the CPU time and the peak of resident
// memory per triangle, and the bytes of every format per vertex. One line of JSON per family and size.
//
//   perf_plan jittered,torus,scan 20000,80000,320000 [N]
#include <ctime>
#include <filesystem>
#include <iostream>

#include "alcap/field_run.h"
#include "alcap/output.h"
#include "perf/common.h"

namespace {

using namespace alcap;

struct Phase {
  std::string name;
  double cpu = 0, peak = 0;
};

/// Ends the phase before, begins one.
class Phases {
 public:
  void begin(std::string_view name) {
    end();
    all_.push_back({std::string(name), -now(), 0});
    std::ofstream("/proc/self/clear_refs") << "5";
  }
  void end() {
    if (all_.empty() || all_.back().peak > 0) return;
    all_.back().cpu += now();
    all_.back().peak = perf::status_bytes("VmHWM:");
  }
  [[nodiscard]] const std::vector<Phase>& all() const { return all_; }

 private:
  static double now() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }
  std::vector<Phase> all_;
};

void measure(const std::string& family, std::int64_t faces, int n) {
  const MeshData s = perf::make_surface(family, faces);
  const double base = perf::status_bytes("VmRSS:") - 8.0 * 3 * double(s.V.rows()) - 12.0 * double(s.F.rows());
  Phases phases;
  FieldRunOptions options{.n = n};
  options.control.progress = [&](std::string_view phase, double fraction) {
    if (fraction <= 0) phases.begin(phase);
  };
  const FieldRun run = run_field(s.V, s.F, options);
  phases.end();
  const double count = double(s.F.rows());
  std::cout << "{\"family\": \"" << family << "\", \"faces\": " << s.F.rows() << ", \"n\": " << n;
  for (const Phase& p : phases.all())
    std::cout << ", \"" << p.name << "\": {\"us\": " << 1e6 * p.cpu / count
              << ", \"bytes\": " << (p.peak - base) / count << "}";
  const auto folder = std::filesystem::temp_directory_path() / "alcap-perf-plan";
  std::filesystem::create_directories(folder);
  const FieldOutput output{.surface = run.surface, .field = run.field, .singularities = run.singularities};
  for (const std::string format : {"ply", "vtp", "rosy", "rawfield"}) {
    phases.begin(format);
    double bytes = 0;
    for (const auto& path : write_field(output, folder / ("field." + format)))
      bytes += double(std::filesystem::file_size(path));
    phases.end();
    std::cout << ", \"" << format << "\": {\"us\": " << 1e6 * phases.all().back().cpu / count
              << ", \"file bytes\": " << bytes / count << "}";
  }
  std::filesystem::remove_all(folder);
  std::cout << ", \"eigen seconds\": " << run.eigen.at(0).seconds << ", \"iterations\": " << run.eigen.at(0).iterations
            << "}" << std::endl;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::cerr << "perf_plan FAMILIES FACES [N]\n";
    return 2;
  }
  for (const std::string& family : perf::split(argv[1]))
    for (const std::string& faces : perf::split(argv[2]))
      measure(family, std::stoll(faces), argc > 3 ? std::stoi(argv[3]) : 4);
}
