// SPDX-License-Identifier: MIT
//
// outputs.cpp: output files and folders that are complete or not there.
#include "apps/alcap/report/outputs.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <system_error>

#include "alcap/errors.h"
#include "apps/alcap/report/report.h"
#include "apps/alcap/system/system.h"
#include "src/base/atomic_file.h"
#include "src/base/cancel.h"

namespace alcap::app {
namespace {

namespace fs = std::filesystem;

/// Writing ends soon after a signal that ends programs.
class HoldSignals {
 public:
  HoldSignals() : scope_(stop_) {}
  HoldSignals(const HoldSignals&) = delete;
  HoldSignals& operator=(const HoldSignals&) = delete;
  ~HoldSignals() = default;
  static void check() {
    if (HeldSignals::stop_requested()) throw Failure(Exit::interrupted, "interrupted while writing");
  }

 private:
  HeldSignals held_;
  std::function<bool()> stop_ = [] { return HeldSignals::stop_requested(); };
  alcap::detail::ControlScope scope_;
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
  if (!may_write_into(folder)) fail(target, fmt::format("no permission to write into {}", folder.string()));
}

/// A hidden folder beside the target, removed with what is in it unless it was moved away.
class TemporaryFolder {
 public:
  explicit TemporaryFolder(const fs::path& target) {
    const fs::path full = fs::absolute(target);
    try {
      for (int attempt = 0; attempt < 100; ++attempt) {
        path_ = alcap::detail::temporary_name(full);
        if (folder_.make(path_)) return;
      }
      path_.clear();
      fail(target, "cannot create a folder beside it (all names are taken)");
    } catch (const std::system_error& error) {
      path_.clear();
      fail(target, fmt::format("cannot create a folder beside it ({})", error.code().message()));
    }
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() {
    std::error_code ignored;
    if (!path_.empty()) fs::remove_all(path_, ignored);
  }
  [[nodiscard]] const fs::path& path() const { return path_; }
  /// Gives the folder its name; false where another run has made one of this name meanwhile.
  [[nodiscard]] bool move_to(const fs::path& target) {
    std::error_code error, ignored;
    alcap::detail::sync_folder(path_);
    fs::rename(path_, target, error);
    if (error && fs::is_directory(target, ignored)) return false;
    if (error) fail(target, fmt::format("cannot give the finished folder its name ({})", error.message()));
    path_.clear();
    alcap::detail::sync_folder(fs::absolute(target).parent_path());
    return true;
  }

 private:
  fs::path path_;
  NewFolder folder_;
};

fs::path without_slash(const fs::path& path) { return path.has_filename() ? path : path.parent_path(); }

/// Runs `write`; FileErrors are about outputs here.
void run_writer(const std::function<void()>& write) {
  try {
    write();
  } catch (const FileError& e) {
    throw Failure(Exit::output, e.what(), file_details(e));
  } catch (const Cancelled&) {
    throw Failure(Exit::interrupted, "interrupted while writing; nothing was left behind");
  }
}

constexpr const char* last_file = "report.json";
constexpr auto longest_wait = std::chrono::seconds(10);  // for another run that gives its files their names

}  // namespace

void check_writable(const fs::path& file) {
  std::error_code error;
  if (file.filename().empty() || fs::is_directory(file, error)) fail(file, "this is a folder; give the name of a file");
  if (fs::exists(file, error) && !fs::is_regular_file(file, error)) return;  // a pipe or device
  const fs::path final = alcap::detail::follow_links(file);
  if (final.empty()) fail(file, "this symbolic link leads in a circle");
  if (final != file && !fs::exists(final, error)) fail(file, alcap::detail::leads_nowhere(final));
  if (final != file) return check_folder(fs::absolute(final).parent_path(), file);
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
    if (fs::is_symlink(target, error) && !fs::exists(target, error))
      fail(target, "this symbolic link leads nowhere; remove it, or create the folder it names");
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

std::vector<Remark> leftover_remarks(const fs::path& target) {
  std::vector<Remark> remarks;
  if (target.empty()) return remarks;
  for (const fs::path& left : alcap::detail::find_leftovers(fs::absolute(without_slash(target))))
    remarks.push_back({.code = "leftover",
                       .message = fmt::format("{} was left by a run that was killed; no program writes into it, and it "
                                              "can be deleted",
                                              left.string())});
  return remarks;
}

void check_distinct(const std::vector<NamedPath>& outputs, const std::vector<NamedPath>& inputs) {
  const auto same = [](const fs::path& a, const fs::path& b) {
    std::error_code error;
    if (fs::equivalent(a, b, error)) return fs::is_regular_file(a, error);  // two runs of bytes into one pipe are fine
    const fs::path to_a = alcap::detail::follow_links(fs::absolute(a)),
                   to_b = alcap::detail::follow_links(fs::absolute(b));
    return !fs::exists(to_a, error) && fs::weakly_canonical(to_a, error) == fs::weakly_canonical(to_b, error);
  };
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    if (outputs[i].second.empty()) continue;
    for (const auto& [flag, path] : inputs)
      if (!path.empty() && same(path, outputs[i].second))
        throw Failure(Exit::usage,
                      fmt::format("{} {} would replace the {}; give another name", outputs[i].first,
                                  outputs[i].second.string(), flag),
                      {{"option", outputs[i].first}, {"value", outputs[i].second.string()}});
    for (std::size_t j = 0; j < i; ++j)
      if (!outputs[j].second.empty() && same(outputs[i].second, outputs[j].second))
        throw Failure(Exit::usage,
                      fmt::format("{} and {} name the same file, {}; give two names", outputs[j].first,
                                  outputs[i].first, outputs[i].second.string()),
                      {{"option", outputs[i].first}, {"value", outputs[i].second.string()}});
  }
}

void write_guarded(const std::function<void()>& write) {
  const HoldSignals hold;
  run_writer(write);
  HoldSignals::check();
}

std::vector<std::string> write_folder(const fs::path& target, const std::function<void(const fs::path&)>& write) {
  const HoldSignals hold;
  std::error_code error;
  fs::create_directories(fs::absolute(target).parent_path(), error);
  if (error) fail(target, fmt::format("cannot create the folder above it ({})", error.message()));
  TemporaryFolder temporary(target);
  run_writer([&] { write(temporary.path()); });
  HoldSignals::check();

  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(temporary.path())) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end(), [](const std::string& a, const std::string& b) {
    return std::pair(a == last_file, a) < std::pair(b == last_file, b);
  });
  if (!fs::exists(target, error) && temporary.move_to(target)) return names;
  FolderLock lock;
  if (!lock.take(target, longest_wait)) {
    HoldSignals::check();
    fail(target, "another run has been writing into this folder for ten seconds; try again, or give another name");
  }
  fs::remove(target / last_file, error);
  for (const std::string& n : names) {
    fs::rename(temporary.path() / n, target / n, error);
    if (error) fail(target / n, fmt::format("cannot give the finished file its name ({})", error.message()));
  }
  alcap::detail::sync_folder(target);
  return names;
}

}  // namespace alcap::app
