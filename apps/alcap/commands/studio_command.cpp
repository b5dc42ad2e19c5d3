// SPDX-License-Identifier: MIT
//
// studio_command.cpp: `alcap studio`, a page in the browser in which fields are designed by hand.
#include <fmt/core.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <thread>

#include "apps/alcap/commands/commands.h"
#include "apps/alcap/options/cli.h"
#include "apps/alcap/options/shared_options.h"
#include "apps/alcap/options/tolerance_options.h"
#include "apps/alcap/page/html_page.h"
#include "apps/alcap/report/outputs.h"
#include "apps/alcap/report/printable.h"
#include "apps/alcap/studio/passing_file.h"
#include "apps/alcap/studio/studio_server.h"
#include "src/base/atomic_file.h"

namespace alcap::app {
namespace studio_parts {
namespace {

constexpr const char* footer =
    "Examples:\n"
    "  alcap studio bunny.ply                     opens a page; edits go to bunny.design.json beside the mesh\n"
    "  alcap studio bunny.ply --design mine.json  go on with a design, or start one there\n"
    "  alcap design bunny.ply --design mine.json -o out    the same field without a browser\n"
    "\n"
    "The page is served to this machine only. Ctrl-C ends it; nothing is lost.";

struct StudioOptions {
  MeshChoice mesh = {};
  std::filesystem::path design = {};  // beside the mesh
  int n = 4;                          // as alcap field
  ControlTolerances tolerances = {};
  int port = 0;              // any
  bool quiet_start = false;  // --no-open
};

DesignFile start_design(const StudioOptions& options, const std::filesystem::path& file) {
  std::error_code error;
  if (std::filesystem::exists(file, error)) return read_design(file);
  DesignFile design;
  design.n = options.n;
  // Edits change the smoothest field around them and leave it elsewhere.
  design.guidance.source = DesignGuidance::Source::smoothest;
  return design;
}

/// Starts the browser, which init looks after.
void start_browser(const char* page) {
  const pid_t child = ::fork();
  if (child == 0) {
    if (::fork() == 0) {
      ::execlp("xdg-open", "xdg-open", page, nullptr);
      ::_exit(1);
    }
    ::_exit(0);
  }
  int status = 0;
  while (child > 0 && ::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
}

/// Opens the page through a file that only this user can read: a command line is seen by everybody. The file goes when
/// the page is there, or after a while.
void open_browser(const std::string& url, const std::shared_ptr<PassingFile>& file) {
  std::string name = (std::filesystem::temp_directory_path() / "alcap-studio-XXXXXX.html").string();
  const int descriptor = ::mkstemps(name.data(), 5);
  if (descriptor < 0) return;
  const std::string page = "<!doctype html><meta http-equiv=refresh content=\"0;url=" + html_escaped(url) + "\">";
  const bool written = ::write(descriptor, page.data(), page.size()) == static_cast<ssize_t>(page.size());
  ::close(descriptor);
  if (!file->hold(name) || !written) {
    ::unlink(name.c_str());
    return;
  }
  start_browser(name.c_str());
  std::thread([file] {
    std::this_thread::sleep_for(std::chrono::seconds(60));
    file->remove();
  }).detach();
}

Outcome run(const StudioOptions& options, const Common& common, Progress& progress) {
  check_studio();
  const std::filesystem::path file = options.design.empty()
                                         ? std::filesystem::path(options.mesh.path).replace_extension(".design.json")
                                         : options.design;
  check_writable(file);
  progress.phase(fmt::format("reading {}", options.mesh.path.string()));
  MeshFile mesh = read_choice(options.mesh);
  std::vector<Remark> remarks;
  const Surface surface = make_surface(options.mesh, mesh, remarks);
  progress.phase("finding the first field");
  remove_passing_files_at_signals();
  const auto page = std::make_shared<PassingFile>();
  StudioSession session(surface, start_design(options, file), file, options.tolerances);
  progress.clear();
  serve_studio(
      session, {.port = options.port, .title = options.mesh.path.stem().string(), .opened = [page] { page->remove(); }},
      [&](const std::string& url) {
        // Said here and not at the end: there is no end.
        if (common.json) {
          (void)std::fputs((text_of(Json{{"url", url}, {"design", file.string()}}) + "\n").c_str(), stdout);
        } else {
          (void)std::fputs(
              printable(fmt::format("studio        {}\ndesign        {} (saved with every edit)\nCtrl-C ends it.\n",
                                    url, file.string()))
                  .c_str(),
              stdout);
        }
        (void)std::fflush(stdout);
        if (!options.quiet_start) open_browser(url, page);
      });
  return {.report = Json::object()};
}

std::function<Outcome(const Common&, Progress&)> attach(cli::App& app) {
  auto options = std::make_shared<StudioOptions>();
  app.footer(footer);
  add_mesh_options(app, options->mesh);
  add_lengths_option(app, options->mesh);
  app.add_option("--design", options->design, "The design to go on with or to start; edits are saved there")
      ->type_name("FILE");
  app.add_option("-n", options->n, "Symmetry of a new design: 1 vectors, 2 lines, 4 crosses")
      ->type_name("N")
      ->capture_default_str()
      ->check(cli::Range(1, 1000));
  add_tolerance_options(app, options->tolerances);
  app.add_option("--port", options->port, "Port on 127.0.0.1; 0 for any that is free")
      ->type_name("PORT")
      ->check(cli::Range(0, 65535));
  app.add_flag("--no-open", options->quiet_start, "Print the address and do not open a browser");
  return [options](const Common& common, Progress& progress) { return run(*options, common, progress); };
}

}  // namespace
}  // namespace studio_parts

const Command studio_command{"studio", "Design fields by hand in the browser", true, &studio_parts::attach};

}  // namespace alcap::app
