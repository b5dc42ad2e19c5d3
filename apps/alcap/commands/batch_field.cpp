// SPDX-License-Identifier: MIT
//
// batch_field.cpp: `alcap field --batch LIST`. A mesh that fails is a line of the report, not the end of the run.
#include "apps/alcap/commands/batch_field.h"

#include <fmt/core.h>

#include <algorithm>
#include <fstream>
#include <iostream>
#include <map>
#include <mutex>
#include <new>
#include <optional>
#include <set>
#include <sstream>

#include "alcap/batch.h"
#include "alcap/memory.h"
#include "apps/alcap/options/cli.h"
#include "apps/alcap/report/field_files.h"
#include "apps/alcap/report/flags.h"
#include "apps/alcap/report/report.h"
#include "apps/alcap/system/system.h"
#include "src/base/clock.h"
#include "src/base/input_file.h"

namespace alcap::app {
namespace {

/// Paths of the list, relative ones to the list's folder. Empty lines and lines that start with # do not count.
std::vector<std::filesystem::path> read_list(const std::filesystem::path& list) {
  const detail::InputFile input(list, {.what = "list of meshes", .largest = std::int64_t{1} << 30});
  std::istringstream in{std::string(input.bytes())};
  std::vector<std::filesystem::path> paths;
  bool first = true;
  for (std::string line; std::getline(in, line); first = false) {
    if (first && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);  // a byte order mark
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.empty() || line.front() == '#') continue;
    if (line.find('\0') != std::string::npos)
      throw Failure(Exit::input, fmt::format("{}: a name has a zero byte; give one path a line", list.string()),
                    {{"path", list.string()}});
    const std::filesystem::path path(line);
    paths.push_back(path.is_absolute() ? path : list.parent_path() / path);
  }
  if (paths.empty())
    throw Failure(Exit::input, fmt::format("{}: the list names no mesh; give one path a line", list.string()),
                  {{"path", list.string()}});
  return paths;
}

std::filesystem::path field_path(const BatchChoice& choice, const std::filesystem::path& mesh,
                                 const std::string& format) {
  return choice.folder / (mesh.stem().string() + "." + format);
}

/// No output is a mesh of the list. By names without links and dots: a list may be long.
void check_kept(const BatchChoice& choice, const std::vector<std::filesystem::path>& paths, const Common& common) {
  std::error_code error;  // a name that cannot be followed is told when it is read
  std::set<std::filesystem::path> meshes;
  for (const std::filesystem::path& path : paths) meshes.insert(std::filesystem::weakly_canonical(path, error));
  const auto check = [&](const char* flag, const std::filesystem::path& output) {
    if (output.empty() || !meshes.contains(std::filesystem::weakly_canonical(output, error))) return;
    throw Failure(Exit::usage,
                  fmt::format("{} {} would replace a mesh of the list; give another name", flag, output.string()),
                  {{"option", flag}, {"value", output.string()}});
  };
  check("--report", common.report);
  check("--lines", choice.lines);
  if (choice.folder.empty()) return;
  for (const std::filesystem::path& path : paths)
    for (const std::string& format : choice.formats) check("-o", field_path(choice, path, format));
}

/// Fields are named after their meshes, so no two meshes may have the same name.
void check_names(const std::vector<std::filesystem::path>& paths) {
  std::map<std::string, const std::filesystem::path*> seen;
  for (const std::filesystem::path& path : paths) {
    const auto [place, fresh] = seen.emplace(path.stem().string(), &path);
    if (!fresh) {
      throw Failure(Exit::usage,
                    fmt::format("-o: the fields of {} and {} would have the same name; rename one mesh",
                                place->second->string(), path.string()),
                    {{"option", "--output"}});
    }
  }
}

Exit exit_of(const std::exception& error) {
  if (const auto* failure = dynamic_cast<const Failure*>(&error)) return failure->exit();
  if (dynamic_cast<const FileError*>(&error) != nullptr) return Exit::input;
  if (dynamic_cast<const MeshError*>(&error) != nullptr) return Exit::mesh;
  if (dynamic_cast<const OptionError*>(&error) != nullptr) return Exit::usage;
  if (dynamic_cast<const SolveError*>(&error) != nullptr) return Exit::solver;
  if (dynamic_cast<const std::bad_alloc*>(&error) != nullptr) return Exit::solver;
  return Exit::internal;
}

Json line_of(const FieldRun& run, double seconds) {
  double lambda = 0, residual = 0;
  for (std::size_t c = 0; c < run.eigen.size(); ++c) {
    lambda = c == 0 ? run.eigen[c].lambda : std::min(lambda, run.eigen[c].lambda);
    residual = std::max(residual, run.eigen[c].residual);
  }
  if (run.features)
    for (const AlignedPiece& piece : run.features->pieces) residual = std::max(residual, piece.residual);
  Json warnings = Json::array();
  for (const Remark& r : run.remarks) {
    if (r.warning) warnings.push_back(r.code);
  }
  return {{"ok", run.certificate.holds()},
          {"vertices", run.mesh().vertices()},
          {"faces", run.mesh().faces()},
          {"components", run.topology().components.size()},
          {"lambda", run.features ? Json(nullptr) : number(lambda)},
          {"residual", number(residual)},
          {"smallest", name(run.certificate.smallest)},
          {"singularities", run.singularities.size()},
          {"seconds", seconds},
          {"warnings", std::move(warnings)}};
}

/// Lines in the order of the list, whatever the order they come in.
class Lines {
 public:
  Lines(std::ostream* out, bool keep) : out_(out), keep_(keep) {}

  void add(std::int64_t i, Json line) {
    const std::lock_guard lock(mutex_);
    if (!line["ok"].get<bool>()) ++failed_;
    waiting_.emplace(i, std::move(line));
    for (auto first = waiting_.begin(); first != waiting_.end() && first->first == next_; first = waiting_.begin()) {
      if (out_ != nullptr) {
        *out_ << text_of(first->second) << "\n" << std::flush;
        if (!*out_) throw Failure(Exit::output, "cannot write the lines of the batch");
      }
      if (keep_) kept_.push_back(std::move(first->second));
      waiting_.erase(first);
      ++next_;
    }
  }
  [[nodiscard]] std::int64_t failed() const { return failed_; }
  [[nodiscard]] Json take() { return std::move(kept_); }

 private:
  std::ostream* out_;
  bool keep_;
  std::mutex mutex_;
  std::map<std::int64_t, Json> waiting_;
  std::int64_t next_ = 0, failed_ = 0;
  Json kept_ = Json::array();
};

void write_fields(const BatchChoice& choice, const MeshChoice& mesh, const FieldRun& run, bool unit) {
  std::vector<std::filesystem::path> paths;
  for (const std::string& f : choice.formats) paths.push_back(field_path(choice, mesh.path, f));
  write_guarded([&] { (void)write_field(output_of(run, unit), paths); });
}

/// What a batch is told about as a whole.
struct Summed {
  std::int64_t count;
  double seconds;
  bool lines_in_report, summary;
};

Outcome outcome_of(const BatchChoice& choice, Lines& lines, const Summed& run) {
  const double per_second = double(run.count) / run.seconds;
  Outcome outcome{.report = report_head("field", lines.failed() == 0)};
  outcome.report["batch"] = {{"list", choice.list.string()},
                             {"meshes", run.count},
                             {"failed", lines.failed()},
                             {"seconds", run.seconds},
                             {"meshes_per_second", number(per_second)}};
  outcome.report["peak_memory_bytes"] = peak_memory_bytes();
  if (run.lines_in_report) outcome.report["meshes"] = lines.take();
  if (run.summary)
    outcome.text = fmt::format("{} meshes in {:.2f} s, {:.1f} a second; {} failed\n", grouped(run.count), run.seconds,
                               per_second, grouped(lines.failed()));
  if (lines.failed() > 0) {
    outcome.exit = Exit::uncertified;
    outcome.complaint = fmt::format("{} of {} meshes failed; their lines say why", lines.failed(), run.count);
  }
  return outcome;
}

}  // namespace

void add_batch_options(cli::App& app, BatchChoice& choice) {
  app.add_option(
         "--batch", choice.list,
         "Instead of MESH: a file with the path of a mesh in each line. One JSON line per mesh goes to stdout; a "
         "mesh that fails is such a line too. With -o FOLDER every field is written to FOLDER/NAME.ply")
      ->type_name("LIST")
      ->group("Batch");
  app.add_option("-j,--jobs", choice.jobs, "Meshes of the batch at a time, each on one thread; 0 for all threads")
      ->type_name("N")
      ->capture_default_str()
      ->check(cli::Range(0, 4096))
      ->group("Batch");
  app.add_option("--lines", choice.lines, "Write the JSON lines of the batch to this file")
      ->type_name("FILE")
      ->group("Batch");
}

Outcome run_field_batch(const BatchChoice& choice, const MeshChoice& mesh, const FieldRunOptions& field,
                        const Common& common) {
  const detail::Stopwatch total;
  const std::vector<std::filesystem::path> paths = read_list(choice.list);
  check_kept(choice, paths, common);
  if (!choice.folder.empty()) {
    check_names(paths);
    std::error_code error;
    std::filesystem::create_directories(choice.folder, error);
    if (!std::filesystem::is_directory(choice.folder))
      throw Failure(Exit::output, fmt::format("cannot create the folder {}", choice.folder.string()));
  }
  check_distinct({{"--report", common.report}, {"--lines", choice.lines}}, {{"list", choice.list}});
  std::optional<std::ofstream> file;
  if (!choice.lines.empty()) {
    check_writable(choice.lines);
    file.emplace(choice.lines, std::ios::trunc);
  }
  const bool to_stdout = !file && !common.json && !common.quiet;
  Lines lines(file ? &*file : to_stdout ? &std::cout : nullptr, common.json && !file);
  const auto head = [&](std::int64_t i) {
    return Json{{"index", i}, {"input", paths[static_cast<std::size_t>(i)].string()}};
  };
  one_thread_for_blas();
  run_batch(
      static_cast<std::int64_t>(paths.size()), {.field = field, .jobs = choice.jobs},
      [&](Context& context, std::int64_t i) {
        const detail::Stopwatch watch;
        MeshChoice one = mesh;
        one.path = paths[static_cast<std::size_t>(i)];
        MeshFile read = read_choice(one);
        const FieldRun& run = context.run(std::move(read.V), std::move(read.F));
        if (!choice.folder.empty()) write_fields(choice, one, run, field.normalise);
        Json line = head(i);
        line.update(line_of(run, watch.seconds()));
        lines.add(i, std::move(line));
      },
      [&](std::int64_t i, const std::exception& error) {
        Json line = head(i);
        line["ok"] = false;
        line["error"] = {{"kind", name(exit_of(error))}, {"message", in_flags(error.what())}};
        lines.add(i, std::move(line));
      });

  return outcome_of(choice, lines,
                    {.count = static_cast<std::int64_t>(paths.size()),
                     .seconds = total.seconds(),
                     .lines_in_report = common.json && !file,
                     .summary = !to_stdout});
}

}  // namespace alcap::app
