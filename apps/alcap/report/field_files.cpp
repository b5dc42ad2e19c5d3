// SPDX-License-Identifier: MIT
#include "apps/alcap/report/field_files.h"
#include "apps/alcap/options/cli.h"

#include <fmt/format.h>

#include <algorithm>

namespace alcap::app {

void add_files_options(cli::App& app, FilesChoice& choice) {
  app.add_option("-o,--output", choice.output,
                 "Folder to create (or fill), or one file whose extension picks the format. Without it nothing is "
                 "written")
      ->type_name("OUT");
  app.add_option(
         "--formats", choice.formats,
         "The files in the folder: ply, vtp, rawfield, rosy, csv, npy, dmat, vertex.rawfield, vertex.csv, ..., or "
         "all. Default: ply,vtp")
      ->type_name("LIST")
      ->delimiter(',')
      ->allow_extra_args(false);
  app.add_option_function<std::string>(
         "--for",
         [&choice](const std::string& text) {
           choice.reader = from_name<Reader>(text);
           if (!choice.reader) throw cli::ValidationError("--for", text + " not in {quadwild,directional}");
         },
         "Write the files that this program reads, mesh included, into the folder: quadwild or directional")
      ->type_name("PROGRAM");
}

std::vector<std::string> chosen_formats(const FilesChoice& choice) {
  if (choice.formats.empty()) return usual_field_formats();
  const std::vector<std::string> known = field_formats();
  if (choice.formats == std::vector<std::string>{"all"}) return known;
  for (const std::string& f : choice.formats) {
    if (std::find(known.begin(), known.end(), f) == known.end())
      throw Failure(Exit::usage, fmt::format("--formats {}: unknown; known are {}", f, fmt::join(known, ", ")),
                    {{"option", "--formats"}, {"value", f}});
  }
  return choice.formats;
}

OutputPlan plan_files(const FilesChoice& choice) {
  (void)chosen_formats(choice);
  std::vector<std::string> extensions;
  for (const std::string& f : field_formats()) extensions.push_back("." + f);
  OutputPlan plan = plan_output(choice.output, extensions);
  if (plan.kind != OutputPlan::Kind::folder && !choice.formats.empty())
    throw Failure(Exit::usage, "--formats needs -o FOLDER; the extension of a file already says its format",
                  {{"option", "--formats"}});
  if (choice.reader && !choice.formats.empty())
    throw Failure(Exit::usage, "--for and --formats exclude each other", {{"option", "--for"}});
  if (choice.reader && plan.kind != OutputPlan::Kind::folder)
    throw Failure(Exit::usage, "--for writes several files, so it needs -o FOLDER", {{"option", "--for"}});
  return plan;
}

namespace {

/// Whether write_files() puts a file of this name into a folder, in one format or another, or for another program.
bool is_written(const std::string& name, bool handed_over) {
  if (name == "design.json" || name == "field_singularities.vtp") return true;
  if (name.starts_with("mode-")) return !field_format(name).empty();
  return name.starts_with("field.") &&
         (!field_format(name).empty() || name.ends_with(".sings") || name.ends_with(".sharp") ||
          (handed_over && (name.ends_with(".obj") || name.ends_with(".off") || name.ends_with(".txt"))));
}

}  // namespace

void check_names(const OutputPlan& plan, const FilesChoice& choice, const std::vector<NamedPath>& others,
                 const std::vector<NamedPath>& inputs) {
  std::vector<NamedPath> outputs = others;
  if (plan.kind == OutputPlan::Kind::folder) {
    for (const auto& [flag, path] : others) {
      const std::string name = path.filename().string();
      if (is_written(name, choice.reader.has_value())) outputs.emplace_back("-o", plan.target / name);
    }
    // A design that lies in the folder may be gone on with: design.json has all that was asked.
    for (const auto& [what, path] : inputs)
      if (const std::string name = path.filename().string();
          what == "mesh" && is_written(name, choice.reader.has_value()))
        outputs.emplace_back("-o", plan.target / name);
  } else if (plan.kind == OutputPlan::Kind::file) {
    outputs.emplace_back("-o", plan.target);
    if (plan.target.extension() == ".rawfield")
      outputs.emplace_back("-o", std::filesystem::path(plan.target).replace_extension(".sings"));
  }
  check_distinct(outputs, inputs);
}

namespace {

/// Of one name: the formats asked for and the feature edges, or what the reader wants.
std::vector<std::filesystem::path> write_chosen(const FilesChoice& choice, const FieldOutput& output,
                                                const FeatureGraph* features, const std::filesystem::path& stem) {
  if (choice.reader) return write_for(*choice.reader, output, features, stem);
  const auto with = [&](const std::string& extension) {
    return std::filesystem::path(stem.string() + "." + extension);
  };
  std::vector<std::filesystem::path> paths;
  for (const std::string& f : chosen_formats(choice)) paths.push_back(with(f));
  paths = write_field(output, paths);
  if (features == nullptr) return paths;
  paths.push_back(with("sharp"));
  write_sharp(output.surface, *features, paths.back());
  return paths;
}

}  // namespace

void write_files(const OutputPlan& plan, const FilesChoice& choice, const FieldOutput& output,
                 const FeatureGraph* features,
                 const std::function<std::vector<std::string>(const std::filesystem::path& folder)>& extra,
                 const std::function<const Json&(const std::vector<std::string>& files)>& finish) {
  std::vector<std::string> files;
  if (plan.kind == OutputPlan::Kind::folder) {
    write_folder(plan.target, [&](const std::filesystem::path& folder) {
      const auto add = [&](const std::filesystem::path& name) { files.push_back((plan.target / name).string()); };
      for (const auto& path : write_chosen(choice, output, features, folder / "field")) add(path.filename());
      for (const std::string& name : extra(folder)) add(name);
      add("report.json");
      write_text(folder / "report.json", text_of(finish(files), 2) + "\n");
    });
    return;
  }
  if (plan.kind == OutputPlan::Kind::file)
    write_guarded([&] {
      for (const auto& path : write_field(output, plan.target)) files.push_back(path.string());
    });
  (void)finish(files);
}

}  // namespace alcap::app
