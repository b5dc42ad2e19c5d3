// SPDX-License-Identifier: MIT
//
// outputs.cpp: output files and folders that are complete or not there.
#include "apps/alcap/report/outputs.h"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <system_error>

#include "alcap/errors.h"
#include "apps/alcap/report/report.h"
#include "src/base/atomic_file.h"

namespace alcap::app {
namespace {

namespace fs = std::filesystem;

volatile std::sig_atomic_t stop_requested = 0;

/// While it lives, the signals that end programs are only noted.
class HoldSignals {
 public:
  HoldSignals() {
    struct sigaction hold = {};
    hold.sa_handler = [](int) { stop_requested = 1; };
    for (std::size_t k = 0; k < signals.size(); ++k) ::sigaction(signals[k], &hold, &before_[k]);
  }
  HoldSignals(const HoldSignals&) = delete;
  HoldSignals& operator=(const HoldSignals&) = delete;
  ~HoldSignals() {
    for (std::size_t k = 0; k < signals.size(); ++k) ::sigaction(signals[k], &before_[k], nullptr);
  }
  static void check() {
    if (stop_requested != 0) throw Failure(Exit::interrupted, "interrupted; nothing was left behind");
  }

 private:
  static constexpr std::array signals{SIGINT, SIGTERM, SIGHUP};
  std::array<struct sigaction, signals.size()> before_{};
};

[[noreturn]] void fail(const fs::path& path, const std::string& what) {
  throw Failure(Exit::output, fmt::format("{}: {}", path.string(), what), {{"path", path.string()}});
}

/// The nearest folder above `path` that exists.
fs::path existing_parent(const fs::path& path) {
  fs::path parent = fs::absolute(path).parent_path();
  std::error_code error;
  while (!fs::exists(parent, error) && parent.has_relative_path()) parent = parent.parent_path();
  return parent;
}

void check_folder(const fs::path& folder, const fs::path& target) {
  std::error_code error;
  if (!fs::exists(folder, error)) fail(target, fmt::format("there is no folder {}; create it first", folder.string()));
  if (!fs::is_directory(folder, error)) fail(target, fmt::format("{} is not a folder", folder.string()));
  if (::access(folder.c_str(), W_OK | X_OK) != 0) {
    fail(target, fmt::format("no permission to write into {}", folder.string()));
  }
}

/// A hidden folder beside the target, removed with what is in it unless it was moved away.
class TemporaryFolder {
 public:
  explicit TemporaryFolder(const fs::path& target) {
    const fs::path full = fs::absolute(target);
    path_ = full.parent_path() / fmt::format(".{}.tmp-{}", full.filename().string(), ::getpid());
    std::error_code error;
    fs::remove_all(path_, error);  // of a killed process with our number
    fs::create_directory(path_, error);
    if (error) fail(target, fmt::format("cannot create a folder beside it ({})", error.message()));
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

fs::path without_slash(const fs::path& path) { return path.has_filename() ? path : path.parent_path(); }

/// Runs `write`; FileErrors are about outputs here.
void run_writer(const std::function<void()>& write) {
  try {
    write();
  } catch (const FileError& e) {
    throw Failure(Exit::output, e.what(), file_details(e));
  }
}

constexpr const char* last_file = "report.json";

}  // namespace

void check_writable(const fs::path& file) {
  std::error_code error;
  if (file.filename().empty() || fs::is_directory(file, error)) fail(file, "this is a folder; give the name of a file");
  if (fs::exists(file, error) && !fs::is_regular_file(file, error)) return;  // a pipe or device
  // The folder may be one that this very run creates (-o out --report out/report.json), so only what exists is checked.
  check_folder(existing_parent(file), file);
}

void write_text(const fs::path& file, std::string_view text) {
  write_guarded([&] {
    alcap::detail::AtomicFile out(file);
    out.write(text);
    out.commit();
  });
}

OutputPlan plan_output(const fs::path& path, const std::vector<std::string>& extensions) {
  if (path.empty()) return {};
  std::error_code error;
  const bool slash = !path.has_filename();
  const fs::path target = without_slash(path);
  std::string extension = target.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  const bool known =
      !extension.empty() && std::find(extensions.begin(), extensions.end(), extension) != extensions.end();
  if (fs::is_directory(target, error) || slash || extension.empty()) {
    if (fs::exists(target, error) && !fs::is_directory(target, error)) {
      fail(target, "exists and is not a folder; give another name, or a file name with an extension");
    }
    check_folder(fs::is_directory(target, error) ? target : existing_parent(target), target);
    return {OutputPlan::Kind::folder, target};
  }
  if (!known) {
    std::string list;
    for (const std::string& e : extensions) list += (list.empty() ? "" : ", ") + e;
    throw Failure(Exit::usage,
                  fmt::format("-o {}: unknown extension {} (known: {}); for a folder of that name put a / at its end",
                              path.string(), extension, list),
                  {{"option", "-o"}, {"value", path.string()}});
  }
  check_writable(target);
  check_folder(fs::absolute(target).parent_path(), target);
  return {OutputPlan::Kind::file, target};
}

void write_guarded(const std::function<void()>& write) {
  const HoldSignals hold;
  run_writer(write);
}

std::vector<std::string> write_folder(const fs::path& target, const std::function<void(const fs::path&)>& write) {
  const HoldSignals hold;
  std::error_code error;
  fs::create_directories(fs::absolute(target).parent_path(), error);
  if (error) fail(target, fmt::format("cannot create the folder above it ({})", error.message()));
  const TemporaryFolder temporary(target);
  run_writer([&] { write(temporary.path()); });
  HoldSignals::check();

  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(temporary.path())) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end(), [](const std::string& a, const std::string& b) {
    return std::pair(a == last_file, a) < std::pair(b == last_file, b);
  });
  if (!fs::exists(target, error)) {
    fs::rename(temporary.path(), target, error);
    if (error) fail(target, fmt::format("cannot give the finished folder its name ({})", error.message()));
    return names;
  }
  fs::remove(target / last_file, error);
  for (const std::string& n : names) {
    fs::rename(temporary.path() / n, target / n, error);
    if (error) fail(target / n, fmt::format("cannot give the finished file its name ({})", error.message()));
  }
  return names;
}

}  // namespace alcap::app
