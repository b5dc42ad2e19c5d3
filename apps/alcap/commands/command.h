// SPDX-License-Identifier: MIT
//
// command.h: what a subcommand is. Each lives in one file, <name>_command.cpp, which defines `const Command
// <name>_command`; one line of commands.h puts it on the command line.
#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <utility>

#include "apps/alcap/report/progress.h"

namespace alcap::app::cli {
class App;
}

namespace alcap::app {

/// Keys keep the order in which they were set.
using Json = nlohmann::ordered_json;

/// As text, on one line or indented. Names of files need not be UTF-8: what is not is replaced.
inline std::string text_of(const Json& json, int indent = -1) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

/// What the shell gets. Part of the interface: docs/cli.md.
enum class Exit {
  ok = 0,
  internal = 1,      ///< a bug in alcap
  usage = 2,         ///< options that make no sense
  input = 3,         ///< an input file is missing or malformed
  mesh = 4,          ///< the mesh was read but cannot be used
  uncertified = 5,   ///< results were written, but their certificate does not hold
  output = 6,        ///< an output could not be written
  solver = 7,        ///< a solver gave up, or memory ran out
  unmet = 8,         ///< results were written and certified, but a control of the design is not met
  interrupted = 130  ///< stopped by a signal while writing; nothing is left behind
};

/// A failure that already knows its exit code; `details` are added to the "error" object of --json.
class Failure : public std::runtime_error {
 public:
  Failure(Exit exit, const std::string& what, Json details = Json::object())
      : std::runtime_error(what), exit_(exit), details_(std::move(details)) {}
  [[nodiscard]] Exit exit() const { return exit_; }
  [[nodiscard]] const Json& details() const { return details_; }

 private:
  Exit exit_;
  Json details_;
};

/// Options that every subcommand has.
struct Common {
  bool json = false;
  bool quiet = false;
  int threads = 0;
  std::filesystem::path report = {};  ///< empty: no report file
};

/// What a subcommand hands back: `report` goes to stdout with --json and to --report FILE, `text` to stdout otherwise.
struct Outcome {
  Exit exit = Exit::ok;
  Json report = Json::object();
  std::string text = {};
  std::string complaint = {};  ///< one line for stderr when exit is not ok
};

struct Command {
  const char* name;
  const char* summary;  ///< one line for `alcap --help`
  bool computes;        ///< whether it takes --threads and --report
  /// Adds its options to `app`; the function it returns runs the command once they are parsed.
  std::function<Outcome(const Common&, Progress&)> (*attach)(cli::App& app);
};

}  // namespace alcap::app
