// SPDX-License-Identifier: MIT
//
// `alcap field --png` and `--curves`: pictures that show what they should, and the errors around them.
#include <doctest/doctest.h>

#ifdef ALCAP_TEST_PNG
#include <png.h>
#endif

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "tests/cli/cli_runner.h"

namespace alcap::test {
namespace {

#ifdef ALCAP_TEST_PNG
struct Image {
  int width = 0, height = 0;
  std::vector<unsigned char> bytes;  // RGB
  [[nodiscard]] const unsigned char* at(int x, int y) const {
    return &bytes[3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x))];
  }
  /// Share of the pixels for which the test holds.
  template <class Test>
  [[nodiscard]] double share(Test&& test) const {
    double count = 0;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) count += test(at(x, y));
    return count / (width * height);
  }
};

Image read_png(const std::filesystem::path& file) {
  png_image header = {};
  header.version = PNG_IMAGE_VERSION;
  REQUIRE(png_image_begin_read_from_file(&header, file.c_str()));
  header.format = PNG_FORMAT_RGB;
  Image image{static_cast<int>(header.width), static_cast<int>(header.height), {}};
  image.bytes.resize(PNG_IMAGE_SIZE(header));
  REQUIRE(png_image_finish_read(&header, nullptr, image.bytes.data(), 0, nullptr));
  return image;
}

using Color = std::array<int, 3>;

Color color_of(const unsigned char* c) { return {c[0], c[1], c[2]}; }

/// By day, of the page's style sheet.
Color page_color(const std::string& name) {
  const std::string style = CliFolder::read(std::filesystem::path(ALCAP_SOURCE_DIR) / "apps/viewer/style.css");
  const std::size_t at = style.find("--" + name + ": #");
  REQUIRE(at != std::string::npos);
  const int rgb = std::stoi(style.substr(at + name.size() + 5, 6), nullptr, 16);
  return {rgb >> 16 & 255, rgb >> 8 & 255, rgb & 255};
}

double linear(int byte) {
  const double c = byte / 255.0;
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

/// Whether this is the colour of something under more or less light.
bool lit(const unsigned char* c, const Color& color) {
  double product = 0, square = 0, rest = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    product += linear(c[k]) * linear(color[k]);
    square += linear(color[k]) * linear(color[k]);
  }
  const double light = product / square;
  for (std::size_t k = 0; k < 3; ++k) rest += std::abs(linear(c[k]) - light * linear(color[k]));
  return light > 0.6 && light < 1.1 && rest < 0.02;
}

bool light(const unsigned char* c) { return c[0] > 225 && c[1] > 225 && c[2] > 225; }
bool dark(const unsigned char* c) { return c[0] < 120 && c[1] < 120 && c[2] < 130; }
bool orange(const unsigned char* c) { return c[0] > 140 && c[0] > c[1] + 60 && c[1] > c[2]; }
bool blue(const unsigned char* c) { return c[2] > 110 && c[2] > c[0] + 70; }
#endif

/// Whether this machine makes pictures; when it does not, that is said and nothing is left behind.
bool pictures(const CliFolder& folder) {
  folder.write("ball.off", icosphere(2));
  const CliResult r = folder.run("field ball.off --png probe.png --png-size 64,64 -q");
  if (r.exit == 0) return true;
  CHECK(r.exit == 6);
  CHECK(r.error_says("apt-get install"));
  CHECK(folder.files().count("probe.png") == 0);
#ifdef ALCAP_TEST_PNG
  MESSAGE("SKIPPED: no picture was looked at, because there is no OpenGL here: " << r.err);
#else
  MESSAGE("SKIPPED: no picture was looked at: built without");
#endif
  return false;
}

TEST_CASE("A picture shows the mesh in its middle, curves on it and singularities of both signs") {
  const CliFolder folder;
  if (!pictures(folder)) return;
#ifdef ALCAP_TEST_PNG
  // A torus under a bad field has singularities of both signs; a bumpy ball has more than its eight.
  folder.write("bumpy.off", bumpy_sphere(4, 0.5, 4));
  const CliResult r = folder.run("field bumpy.off -n 4 --png a.png --png-size 400,300 --json");
  REQUIRE(r.exit == 0);
  const Json report = r.json();
  CHECK(report["files"].back() == "a.png");
  REQUIRE(report["singularities"]["negative"] > 0);
  const Image image = read_png(folder.work() / "a.png");
  CHECK(image.width == 400);
  CHECK(image.height == 300);
  for (const int x : {0, 399})
    for (const int y : {0, 299}) CHECK(light(image.at(x, y)));
  const double mesh = image.share([](const unsigned char* c) { return !light(c); });
  CHECK(mesh > 0.25);
  CHECK(mesh < 0.75);
  CHECK(image.share(dark) > 0.02);  // curves
  CHECK(image.share(dark) < 0.5 * mesh);
  CHECK(image.share(orange) > 2e-4);
  CHECK(image.share(blue) > 2e-4);
#endif
}

TEST_CASE("A picture has the colours of the page, and its marks: balls and octahedra with their branches") {
  const CliFolder folder;
  if (!pictures(folder)) return;
#ifdef ALCAP_TEST_PNG
  folder.write("bumpy.off", bumpy_sphere(4, 0.5, 4));
  REQUIRE(folder.run("field bumpy.off -n 4 --png a.png --png-size 1600,1200").exit == 0);
  const Image image = read_png(folder.work() / "a.png");
  for (const int x : {0, 800, 1599})
    for (const int y : {0, 1199}) CHECK(color_of(image.at(x, y)) == page_color("canvas"));
  const auto is = [](const Color& color) { return [=](const unsigned char* c) { return color_of(c) == color; }; };
  CHECK(image.share(is(page_color("ink"))) > 0.005);
  for (const char* sign : {"positive", "negative"}) {
    CAPTURE(sign);
    const Color color = page_color(sign);
    CHECK(image.share(is(color)) > 1e-4);  // branches are flat
    std::map<Color, int> shades;
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x)
        if (lit(image.at(x, y), color) && color_of(image.at(x, y)) != color) ++shades[color_of(image.at(x, y))];
    const auto often = std::count_if(shades.begin(), shades.end(), [](const auto& s) { return s.second > 60; });
    // Octahedra show four facets, all the same ones; balls have every shade.
    if (color == page_color("negative")) {
      CHECK(often >= 2);
      CHECK(often <= 4);
    } else {
      CHECK(shades.size() > 30);
    }
  }
#endif
}

TEST_CASE("The same command makes the same picture; the view and the spacing change it") {
  const CliFolder folder;
  if (!pictures(folder)) return;
  folder.write("bumpy.off", bumpy_sphere(3, 0.3, 3));
  const auto picture = [&](const std::string& options) {
    REQUIRE(folder.run("field bumpy.off --png p.png --png-size 200,150 " + options).exit == 0);
    return CliFolder::read(folder.work() / "p.png");
  };
  const std::string first = picture("");
  CHECK(picture("") == first);
  CHECK(picture("--view 120,-30") != first);
  CHECK(picture("--up z") != first);
  CHECK(picture("--curve-spacing 0.1") != first);
}

TEST_CASE("Pictures of the smallest, the flat and the wide") {
  const CliFolder folder;
  if (!pictures(folder)) return;
  folder.write("one.off", single_triangle());
  folder.write("flat.off", grid(20, 2, 10, 1));
  for (const char* mesh : {"one.off", "flat.off"})
    for (const char* n : {"1", "2", "4"})
      for (const char* view : {"0,0", "90,0", "0,90"}) {
        CAPTURE(mesh);
        CAPTURE(view);
        CHECK(folder.run(std::string("field ") + mesh + " -n " + n + " --png p.png --png-size 64,16 --view " + view)
                  .exit == 0);
      }
}

TEST_CASE("pictures and curves may lie in the folder of the fields, under names that no field takes") {
  const CliFolder folder;
  folder.write("ball.off", icosphere(2));
  REQUIRE(folder.run("field ball.off -o out").exit == 0);
  for (const char* name : {"field.json", "field.obj", "curves.vtp"}) {
    CAPTURE(std::string(name));
    const CliResult r = folder.run(std::string("field ball.off -o out --curves out/") + name);
    CHECK(r.exit == 0);
    CHECK(std::filesystem::exists(folder.work() / "out" / name));
  }
  for (const char* name : {"field.vtp", "field_singularities.vtp"}) {
    const CliResult r = folder.run(std::string("field ball.off -o out --curves out/") + name);
    CHECK(r.exit == 2);
    CHECK(r.error_says("name the same file"));
  }
}

TEST_CASE("Curves are written in every format, on the surface, with the reasons of their ends") {
  const CliFolder folder;
  folder.write("ball.off", icosphere(3));
  for (const char* format : {"json", "obj", "vtp"}) {
    const CliResult r = folder.run(std::string("field ball.off -n 2 --curve-spacing 0.03 --json --curves c.") + format);
    REQUIRE(r.exit == 0);
    CHECK(r.json()["files"] == Json::array({std::string("c.") + format}));
  }
  const Json curves = folder.read_json("c.json");
  CHECK(curves["n"] == 2);
  CHECK(curves["curves"].size() > 10);
  std::size_t points = 0;
  for (const Json& curve : curves["curves"]) {
    points += curve["points"].size();
    CHECK(curve["faces"].size() == curve["points"].size());
    CHECK(curve["end"] != "seed");
    for (const Json& p : curve["points"]) {
      const double r = std::hypot(p[0].get<double>(), p[1].get<double>(), p[2].get<double>());
      CHECK(r > 0.97);
      CHECK(r <= 1 + 1e-12);
    }
  }
  std::istringstream obj(CliFolder::read(folder.work() / "c.obj"));
  std::size_t vertices = 0, lines = 0, ends = 0;
  for (std::string line; std::getline(obj, line);) {
    vertices += line.starts_with("v ");
    if (!line.starts_with("l ")) continue;
    ++lines;
    std::istringstream words(line.substr(2));
    for (std::size_t i = 0; words >> i;) CHECK(i == ++ends);
  }
  CHECK(vertices == points);
  CHECK(ends == points);
  CHECK(lines == curves["curves"].size());
}

TEST_CASE("What cannot be written is said before anything is computed") {
  const CliFolder folder;
  folder.write("ball.off", icosphere(1));
  CHECK(folder.run("field ball.off --png p.jpg").exit == 2);
  CHECK(folder.run("field ball.off --curves c.txt").error_says(".vtp"));
  CHECK(folder.run("field ball.off --png-size 0,10 --png p.png").exit == 2);
  CHECK(folder.run("field ball.off --curve-spacing 0 --png p.png").exit == 2);
  CHECK(folder.run("field ball.off --up x --png p.png").exit == 2);
  CHECK(folder.run("field ball.off --curves nowhere/c.obj").exit == 6);
  CHECK(folder.run("field ball.off --png nowhere/p.png").exit == 6);
  CHECK(folder.files() == std::set<std::string>{"ball.off"});
}

}  // namespace
}  // namespace alcap::test
