// SPDX-License-Identifier: MIT
#include "apps/alcap/commands/show_options.h"

#include "apps/alcap/options/cli.h"
#include "apps/alcap/page/html_page.h"
#include "apps/alcap/page/view_scene.h"
#include "apps/alcap/report/outputs.h"
#include "apps/alcap/report/report.h"

namespace alcap::app {

void add_show_options(cli::App& app, ShowOptions& options) {
  app.add_option("--html", options.html, "Also write a page that shows the field in any browser, in one file")
      ->type_name("FILE");
  add_picture_options(app, options.picture);
}

void check_show(const ShowOptions& options) {
  check_picture(options.picture);
  if (options.html.empty()) return;
  check_page();
  check_writable(options.html);
}

ShownCurves trace_show(const FieldOutput& output, const ShowOptions& options, Json& report) {
  ShownCurves curves{.picture = picture_curves(output, options.picture), .page = std::nullopt};
  if (!options.html.empty()) curves.page = page_curves(output);
  if (curves.picture) report["curves"] = curves_json(*curves.picture);
  if ((curves.picture && !curves.picture->complete) || (curves.page && !curves.page->complete()))
    report["warnings"].push_back(remarks_json({curves_cut_short()}, true)[0]);
  return curves;
}

void write_show(const FieldOutput& output, const std::string& title, const ShowOptions& options,
                const ShownCurves& curves, Json& report) {
  if (!options.html.empty()) {
    write_text(options.html, html_page(make_scene(output, *curves.page, title, report)));
    report["files"].push_back(options.html.string());
  }
  for (const std::string& picture : write_pictures(output, curves.picture, options.picture))
    report["files"].push_back(picture);
}

}  // namespace alcap::app
