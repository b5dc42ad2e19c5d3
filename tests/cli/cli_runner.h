// SPDX-License-Identifier: MIT
//
// cli_runner.h: runs the command line tool in a folder of its own and gives back what a user would see.
#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>

#include "alcap/generators.h"
#include "alcap/mesh_io.h"

namespace alcap::test {

using Json = nlohmann::json;

struct CliResult {
  int exit = -1;  ///< -1 when a signal ended it
  std::string out, err;

  /// Standard output as JSON; throws when it is anything else.
  [[nodiscard]] Json json() const { return Json::parse(out); }
  [[nodiscard]] bool error_says(const std::string& text) const { return err.find(text) != std::string::npos; }
};

/// A temporary folder, removed with everything in it at the end.
class CliFolder {
 public:
  CliFolder() {
    static std::atomic<int> count{0};
    path_ = std::filesystem::temp_directory_path() /
            ("alcap-cli-" + std::to_string(::getpid()) + "-" + std::to_string(count++));
    std::filesystem::create_directories(work());
  }
  CliFolder(const CliFolder&) = delete;
  CliFolder& operator=(const CliFolder&) = delete;
  ~CliFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }

  /// Where commands run.
  [[nodiscard]] std::filesystem::path work() const { return path_ / "work"; }

  [[nodiscard]] CliResult run(const std::string& arguments) const {
    const auto out = path_ / "stdout", err = path_ / "stderr";
    const std::string command = "cd '" + work().string() + "' && '" ALCAP_CLI "' " + arguments + " >'" + out.string() +
                                "' 2>'" + err.string() + "' </dev/null";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read(out), read(err)};
  }

  /// Exit code of a shell script in which $ALCAP is the tool; -1 when a signal ended the shell.
  [[nodiscard]] int shell(const std::string& script) const {
    write("../script", script);
    const std::string command = "cd '" + work().string() + "' && ALCAP='" ALCAP_CLI "' bash ../script </dev/null";
    const int status = std::system(command.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(work() / name, std::ios::binary) << text;
  }
  void write(const std::string& name, const MeshData& surface) const {
    write_mesh(work() / name, surface.V, surface.F);
  }
  [[nodiscard]] static std::string read(const std::filesystem::path& file) {
    std::ostringstream text;
    text << std::ifstream(file, std::ios::binary).rdbuf();
    return text.str();
  }
  [[nodiscard]] Json read_json(const std::string& name) const { return Json::parse(read(work() / name)); }

  /// Names of everything in the folder, hidden files too, by path from `work()`.
  [[nodiscard]] std::set<std::string> files() const {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(work())) {
      names.insert(entry.path().lexically_relative(work()).string());
    }
    return names;
  }

 private:
  std::filesystem::path path_;
};

/// Two surfaces side by side as one mesh; nothing is shared.
inline MeshData both(const MeshData& a, const MeshData& b, double shift) {
  MeshData sum;
  sum.V.resize(a.V.rows() + b.V.rows(), 3);
  sum.V << a.V, b.V.rowwise() + Eigen::RowVector3d(shift, 0, 0);
  sum.F.resize(a.F.rows() + b.F.rows(), 3);
  sum.F << a.F, b.F.array() + static_cast<Index>(a.V.rows());
  return sum;
}

}  // namespace alcap::test
