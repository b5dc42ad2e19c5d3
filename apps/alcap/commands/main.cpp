// SPDX-License-Identifier: MIT
//
// main.cpp: parses the command line, runs one subcommand, and turns what comes out of it (a result or any kind of
// failure) into stdout, stderr, a report file and an exit code. Subcommands print nothing themselves.
#include <fmt/core.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <new>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "alcap/conventions.h"
#include "alcap/petsc.h"
#include "alcap/solve.h"
#include "alcap/version.h"
#include "apps/alcap/commands/address_space.h"
#include "apps/alcap/commands/commands.h"
#include "apps/alcap/options/cli.h"
#include "apps/alcap/report/flags.h"
#include "apps/alcap/report/outputs.h"
#include "apps/alcap/report/printable.h"
#include "apps/alcap/report/report.h"
#include "apps/alcap/system/system.h"
#include "src/base/parallel.h"
#include "src/simd/isa.h"

#ifdef __ELF__
// Where coverage is measured; the name is gcc's. NOLINTNEXTLINE(readability-identifier-naming)
extern "C" void __gcov_dump() __attribute__((weak));
#endif

namespace alcap::app {
namespace {

constexpr const char* description =
    "Smoothest n-vector fields on triangle meshes: cross fields (n = 4), line fields, vector fields,\n"
    "with singularities and a certificate.";

constexpr const char* footer =
    "Start with:\n"
    "  alcap info bunny.ply                 is this mesh usable, and if not, why\n"
    "  alcap field bunny.ply -n 4 -o out    a cross field, its files and its report into the folder out\n"
    "\n"
    "Every command has its own --help, and --json for programs.\n"
    "Exit codes: 0 ok, 2 usage, 3 input file, 4 mesh unusable, 5 result not certified, 6 output not\n"
    "written, 7 solver or memory, 8 a control of the design missed, 1 internal error, 130 interrupted.";

std::string version_text() {
  std::string sets, solvers;
  for (const auto isa : detail::available_isas()) sets += std::string(sets.empty() ? "" : ", ") + detail::name(isa);
  for (const auto& name : linear_solvers()) solvers += (solvers.empty() ? "" : ", ") + name;
  return fmt::format("alcap {}\nsolvers: {}\ninstruction set: {} (this machine has {})\n", version(), solvers,
                     detail::name(detail::best_isa()), sets);
}

void print(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0) {
    throw Failure(Exit::output, "cannot write to standard output");
  }
}

/// A line on stderr. When nobody can read it the exit code has to do.
void say(const std::string& command, const std::string& message) {
  const std::string line = "alcap" + (command.empty() ? "" : " " + command) + ": " + printable_line(message) + "\n";
  (void)std::fwrite(line.data(), 1, line.size(), stderr);
}

/// The last resort for what went wrong: one line on stderr, with --json also an object on stdout. Never throws.
int complain(const std::string& command, bool json, Exit exit, const std::string& message,
             const Json& details = Json::object()) noexcept {
  try {
    say(command, message);
    if (json) {
      const std::string text = text_of(error_report(command, exit, message, details), 2) + "\n";
      (void)std::fwrite(text.data(), 1, text.size(), stdout);
      (void)std::fflush(stdout);
    }
  } catch (...) {  // no memory for words
    (void)std::fputs("alcap: out of memory\n", stderr);
  }
  return static_cast<int>(exit);
}

/// Calls body and gives every exception its exit code.
template <class Body>
int guarded(const std::string& command, bool json, Progress& progress, Body&& body) {
  const auto fail = [&](Exit exit, const std::exception& e, const Json& details = Json::object()) {
    progress.clear();
    return complain(command, json, exit, in_flags(e.what()), details);
  };
  try {
    return body();
  } catch (const Failure& e) {
    return fail(e.exit(), e, e.details());
  } catch (const FileError& e) {
    return fail(Exit::input, e, file_details(e));
  } catch (const MeshError& e) {
    progress.clear();
    return complain(command, json, Exit::mesh, fmt::format("{} (alcap info lists all defects)", in_flags(e.what())),
                    mesh_details(e));
  } catch (const OptionError& e) {
    progress.clear();
    const std::string_view flag = flag_of(e.field());
    Json details{{"option", e.field()}, {"value", e.value()}, {"rule", e.rule()}};
    if (!flag.empty()) details["flag"] = flag;
    return complain(command, json, Exit::usage,
                    flag.empty() ? std::string(e.what()) : fmt::format("{} (see {})", e.what(), flag), details);
  } catch (const SolveError& e) {
    return fail(Exit::solver, e);
  } catch (const Cancelled&) {
    progress.clear();
    return complain(command, json, Exit::interrupted, "interrupted");
  } catch (const std::bad_alloc&) {
    progress.clear();
    return complain(command, json, Exit::solver, "out of memory; use a smaller mesh or a machine with more memory");
  } catch (const std::system_error& e) {
    progress.clear();
    if (e.code() == std::errc::resource_unavailable_try_again)
      return complain(command, json, Exit::solver,
                      "the system gives no thread or memory; raise its limits (ulimit -v, ulimit -u)");
    return complain(command, json, Exit::internal, fmt::format("internal error, please report it: {}", e.what()));
  } catch (const std::exception& e) {
    progress.clear();
    // What TBB throws when it gets no thread.
    if (std::string_view(e.what()).starts_with("pthread_create"))
      return complain(command, json, Exit::solver, "the system gives no thread; raise its limits (ulimit -v, -u)");
    return complain(command, json, Exit::internal, fmt::format("internal error, please report it: {}", e.what()));
  }
}

/// No output that has a name of its own is an input. Files inside of folders are the business of the commands.
void check_named_files(const cli::App& app) {
  std::vector<NamedPath> outputs, inputs;
  for (const auto& [name, text] :
       app.given({"--output", "--report", "--html", "--png", "--curves", "--sizing", "--lines"}))
    outputs.emplace_back(name == "--output" ? "-o" : name, text);
  for (const auto& [name, text] : app.given({"mesh", "field", "--mesh", "--batch", "--lengths", "--features",
                                             "--target", "--design", "--stroke", "--guidance"})) {
    const std::string what = name.starts_with("-") ? "file of " + name : name;
    inputs.emplace_back(what, text);
    if (const std::size_t weight = text.rfind(':');
        weight != std::string::npos && (name == "--stroke" || name == "--guidance"))
      inputs.emplace_back(what, text.substr(0, weight));
  }
  check_distinct(outputs, inputs);
}

int run(const Command& command, const cli::App& app, const Common& common,
        const std::function<Outcome(const Common&, Progress&)>& body) {
  Progress progress(!common.quiet);
  return guarded(command.name, common.json, progress, [&] {
    if (command.computes) check_address_space();
    check_named_files(app);
    if (!common.report.empty()) check_writable(common.report);
    Outcome outcome;
    run_with_threads(common.threads, [&] { outcome = body(common, progress); });
    progress.clear();
    if (!common.report.empty()) write_text(common.report, text_of(outcome.report, 2) + "\n");
    if (common.json) {
      print(text_of(outcome.report, 2) + "\n");
    } else if (!common.quiet) {
      print(printable(outcome.text));
    }
    if (!outcome.complaint.empty()) say(command.name, outcome.complaint);
    return static_cast<int>(outcome.exit);
  });
}

void add_common(const Command& command, cli::App& app, Common& common) {
  app.add_flag("--json", common.json, "Print the report as JSON on stdout, and nothing else there")
      ->group("Common options");
  app.add_flag("-q,--quiet", common.quiet, "No summary, no progress; errors still go to stderr")
      ->group("Common options");
  if (!command.computes) return;
  app.add_option("--threads", common.threads, "Threads to use; 0 for all. Results do not depend on it")
      ->check(cli::Range(0, 4096))
      ->group("Common options");
  app.add_option("--report", common.report, "Write the report (JSON) to this file")
      ->type_name("FILE")
      ->group("Common options");
}

/// Memory that one phase frees is taken up by the next instead of going back to the system in between: new pages cost
/// more than most phases do with them (measured at 1.3 million triangles: a third of the system time, for 1 % more
/// memory). The library leaves such settings alone.
void keep_freed_memory() {
#ifdef __GLIBC__
  constexpr int bytes = 1 << 30;
  (void)::mallopt(M_MMAP_THRESHOLD, bytes);
  (void)::mallopt(M_TRIM_THRESHOLD, bytes);
#endif
}

/// Insertions, deletions, exchanges of one letter or of two neighbours that make b of a.
std::size_t distance_between(std::string_view a, std::string_view b) {
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i)
    for (std::size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        d[i][j] = i + j;
        continue;
      }
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0U : 1U)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  return d[a.size()][b.size()];
}

/// "; did you mean field?" for a first word that is nearly a command; empty otherwise.
std::string meant(int argc, char** argv) {
  if (argc < 2 || argv[1][0] == '-') return {};
  const std::string_view word = argv[1];
  std::string best;
  std::size_t least = 1 + word.size() / 3;  // letters that may be wrong
  for (const Command* command : all_commands)
    if (const std::size_t d = distance_between(word, command->name); d > 0 && d <= least) {
      least = d - 1;
      best = command->name;
    }
  return best.empty() ? best : fmt::format("; did you mean alcap {}?", best);
}

int start(int argc, char** argv) {
#ifdef ALCAP_WITH_PETSC
  const auto petsc = register_petsc_backends();
#endif
  cli::App app(description, "alcap");
  app.footer(footer);
  app.require_subcommand(0, 1);
  bool version = false;
  app.add_flag("--version", version, "Version, solvers and instruction sets");

  struct Entry {
    const Command* command;
    cli::App* app;
    Common common;
    std::function<Outcome(const Common&, Progress&)> body;
  };
  std::vector<std::unique_ptr<Entry>> entries;
  for (const Command* command : all_commands) {
    entries.push_back(std::make_unique<Entry>());
    Entry& entry = *entries.back();
    entry.command = command;
    entry.app = app.add_subcommand(command->name, command->summary);
    entry.body = command->attach(*entry.app);
    add_common(*command, *entry.app, entry.common);
  }

  // CLI11 has not stored --json yet when parsing fails.
  bool json = false;
  for (int k = 1; k < argc; ++k) json = json || std::string_view(argv[k]) == "--json";
  try {
    if (const auto help = app.parse(argc, argv)) {
      print(*help);
      return 0;
    }
  } catch (const cli::ParseError& e) {
    const std::string name = app.parsed_subcommand();
    return complain(name, json, Exit::usage,
                    fmt::format("{} (see alcap{}{} --help){}", e.what(), name.empty() ? "" : " ", name,
                                name.empty() ? meant(argc, argv) : ""));
  } catch (const FileError& e) {  // of an option that reads its file at once
    return complain(app.parsed_subcommand(), json, Exit::input, in_flags(e.what()), file_details(e));
  }
  if (version) {
    print(version_text());
    return 0;
  }
  for (const auto& entry : entries) {
    if (entry->app->parsed()) return run(*entry->command, *entry->app, entry->common, entry->body);
  }
  const std::string help = app.help();
  (void)std::fwrite(help.data(), 1, help.size(), stderr);
  return static_cast<int>(Exit::usage);
}

/// Memory may run out where nothing can be thrown any more: in words about an error, in the destructors of nlohmann's
/// lists and objects, which take some, and in the standard library's own noexcept functions (listing a folder), which
/// do not say what was thrown.
std::atomic<bool> memory_ran_out{false};

[[noreturn]] void no_memory() {
  memory_ran_out = true;
  throw std::bad_alloc();
}

[[noreturn]] void end_without_memory() noexcept {
  const std::exception_ptr thrown = std::current_exception();
  bool memory = !thrown && std::uncaught_exceptions() > 0 && memory_ran_out;
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const std::bad_alloc&) {
    memory = true;
  } catch (...) {  // a bug: ended as always
  }
  if (!memory) std::abort();
  (void)std::fputs("alcap: out of memory\n", stderr);
  std::_Exit(static_cast<int>(Exit::solver));
}

/// Ends the program without the exit handlers of libraries: where threads could not be started (ulimit -v), OpenBLAS's
/// waits for them for ever. Sanitizers look for leaks in theirs.
int leave(int code) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  return code;
#else
  (void)std::fflush(nullptr);
#ifdef __ELF__
  if (__gcov_dump != nullptr) __gcov_dump();
#endif
  std::_Exit(code);
#endif
}

}  // namespace
}  // namespace alcap::app

int main(int argc, char** argv) {
  std::set_new_handler(alcap::app::no_memory);
  std::set_terminate(alcap::app::end_without_memory);
  alcap::app::reserve_standard_streams();
  alcap::app::keep_freed_memory();
  alcap::app::Progress silent(false);
  return alcap::app::leave(alcap::app::guarded("", false, silent, [&] { return alcap::app::start(argc, argv); }));
}
