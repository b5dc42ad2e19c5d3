// SPDX-License-Identifier: MIT
//
// test_output_broken.cpp: what fails in writing or reading a field says why, and leaves nothing behind.
#include <doctest/doctest.h>
#include <sys/resource.h>

#include <cmath>
#include <csignal>
#include <cstring>

#include "tests/io/output_fixture.h"

using namespace alcap;
using namespace alcap::test;

TEST_CASE("the extension picks the format, whatever its case; an unknown one names those that are known") {
  CHECK(field_format("a.b/c.d.PLY") == "ply");
  CHECK(field_format("bunny.v2.rawfield") == "rawfield");
  CHECK(field_format("bunny.Vertex.RawField") == "vertex.rawfield");
  CHECK(field_format("vertex.rawfield") == "rawfield");
  CHECK(field_format("ply").empty());
  CHECK(field_format(".ply").empty());
  CHECK(field_format("a.ply/").empty());
  CHECK(field_format("a.plyx").empty());

  const Folder folder;
  const Case c(tetrahedron(), 4);
  const fs::path files[] = {folder.path / "good.ply", folder.path / "bad.step"};
  try {
    write_field(c.output(), files);
    FAIL("an unknown extension was accepted");
  } catch (const FileError& error) {
    CHECK(error.path() == files[1].string());
    for (const std::string& format : field_formats()) {
      CHECK(std::string(error.what()).find("." + format) != std::string::npos);
    }
  }
  CHECK(folder.names().empty());
}

TEST_CASE("a failure leaves no file, and an old one untouched") {
  const Folder folder;
  Case c(icosphere(4), 4);
  c.randomise(1);
  for (const std::string& format : field_formats()) {
    CHECK_THROWS_AS(write_field(c.output(), folder.path / "missing" / ("f." + format)), FileError);
    fs::create_directory(folder.path / ("d." + format));
    CHECK_THROWS_AS(write_field(c.output(), folder.path / ("d." + format)), FileError);
    fs::remove(folder.path / ("d." + format));
  }
  CHECK(folder.names().empty());

  // A full disk: the system refuses to let files grow beyond 64 KB.
  std::ofstream(folder.path / "old.ply") << "old";
  rlimit unlimited = {};
  REQUIRE(::getrlimit(RLIMIT_FSIZE, &unlimited) == 0);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit limited = unlimited;
  limited.rlim_cur = 65536;
  REQUIRE(::setrlimit(RLIMIT_FSIZE, &limited) == 0);
  std::vector<std::string> accepted;
  for (const std::string& format : field_formats()) {
    try {
      write_field(c.output(), folder.path / ("full." + format));
      accepted.push_back(format);
    } catch (const FileError&) {
    }
  }
  bool old_threw = false;
  try {
    write_field(c.output(), folder.path / "old.ply");
  } catch (const FileError&) {
    old_threw = true;
  }
  ::setrlimit(RLIMIT_FSIZE, &unlimited);
  std::signal(SIGXFSZ, old_handler);
  CHECK(accepted.empty());
  CHECK(old_threw);
  CHECK(folder.names() == std::set<std::string>{"old.ply"});
  CHECK(contents(folder.path / "old.ply") == "old");
}

TEST_CASE("what cannot be written is refused before anything is, naming the member") {
  const Folder folder;
  const auto refused = [&](const Case& c, const char* member) {
    for (const std::string& format : field_formats()) {
      try {
        write_field(c.output(), folder.path / ("f." + format));
        FAIL_CHECK(member);
      } catch (const OptionError& error) {
        CHECK(error.field() == member);
      }
    }
    CHECK(folder.names().empty());
  };
  const Case good(icosphere(1), 4);
  Case c = good;
  c.field.frames.reset();
  refused(c, "field.frames");
  c = good;
  c.field.n = 0;
  refused(c, "field.n");
  c = good;
  c.field.u.conservativeResize(3);
  refused(c, "field.u");
  c = good;
  c.field.u[7] = {0, std::nan("")};
  refused(c, "field.u");
  c = good;
  c.connection.K.resize(0);
  refused(c, "connection.K");
  c = good;
  c.singularities.push_back({.face = 80});
  refused(c, "singularities");
  c = good;
  c.extra.resize(79);
  c.scalars = {{"div", c.extra}};
  refused(c, "div");
  c.extra.resize(80);
  c.scalars = {{"K", c.extra}};
  refused(c, "face_scalars");
  c.scalars = {{"div", c.extra}, {"div", c.extra}};
  refused(c, "face_scalars");
}

TEST_CASE("read_field refuses what is no field file, and one cut anywhere") {
  const Folder folder;
  Case c(icosphere(1), 4);
  c.randomise(2);
  const fs::path path = folder.path / "f.ply", broken = folder.path / "broken.ply";
  write_field(c.output(), path);
  const std::string whole = contents(path);
  const auto throws = [&](const std::string& bytes) {
    std::ofstream(broken, std::ios::binary | std::ios::trunc) << bytes;
    try {
      static_cast<void>(read_field(broken));
      return false;
    } catch (const FileError& error) {
      CHECK(error.path() == broken.string());
      return true;
    }
  };
  CHECK_FALSE(throws(whole));
  for (std::size_t size = 0; size < whole.size(); size += size < 1200 ? 1 : 37) CHECK(throws(whole.substr(0, size)));
  CHECK(throws(whole.substr(0, whole.size() - 1)));
  CHECK(throws(whole + "x"));
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string bytes = whole;
    const std::size_t at = bytes.find(from);
    REQUIRE(at != std::string::npos);
    return bytes.replace(at, from.size(), to);
  };
  CHECK(throws(changed("obj_info n 4\n", "")));
  CHECK(throws(changed("obj_info n 4\n", "obj_info n 0\n")));
  CHECK(throws(changed("obj_info n 4\n", "obj_info n 4x\n")));
  CHECK(throws(changed("obj_info alcap_field 1\n", "obj_info alcap_field 2\n")));
  CHECK(throws(changed("connection local", "connection loca")));
  CHECK(throws(changed("property double u_re", "property double v_re")));
  CHECK(throws(changed("property double axis_z", "property float axis_z")));
  CHECK(throws(changed("property double axis_z", "property list uchar double axis_z")));
  CHECK(throws(changed("binary_little_endian", "binary_big_endian")));
  std::string not_finite = whole;
  const double nan = std::nan("");
  std::memcpy(not_finite.data() + whole.find("end_header\n") + 11 + 9 * 8, &nan, 8);  // u_re of vertex 0
  CHECK(throws(not_finite));
  // Lines that say how the connection was made.
  const auto says = [&](const std::string& line, const std::string& what) {
    CHECK(throws(changed("obj_info n 4\n", "obj_info n 4\n" + line + "\n")));
    CHECK_THROWS_WITH_AS(static_cast<void>(read_field(broken)), doctest::Contains(what.c_str()), FileError);
  };
  says("obj_info detail fine", "obj_info detail must be a number, not 'fine'");
  says("obj_info tan_cap inf", "obj_info tan_cap must be a number, not 'inf'");
  says("obj_info center navel", "obj_info center cannot be 'navel'");
  says("obj_info length_factor wide", "obj_info length_factor cannot be 'wide'");
  says("obj_info cone 7", "obj_info cone must be a vertex and an index, not '7'");
  says("obj_info cone -1 1", "obj_info cone must be a vertex and an index, not '-1 1'");
  says("obj_info cone 7 half", "obj_info cone must be a number, not 'half'");
  CHECK_THROWS_AS(static_cast<void>(read_field(folder.path / "missing.ply")), FileError);
  CHECK_THROWS_AS(static_cast<void>(read_field(folder.path)), FileError);
}

// Run by read_vtp.py with ALCAP_SAMPLE_FOLDER set: files to read with VTK, and what has to be found in them.
