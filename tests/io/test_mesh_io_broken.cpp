// SPDX-License-Identifier: MIT
//
// Broken mesh files: each is a FileError that says where and what, and nothing crashes, hangs or asks for memory that
// the file cannot need. Also the writers' refusals and AtomicFile.
#include <alcap/mesh_io.h>
#include <doctest/doctest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <thread>

#include "src/base/atomic_file.h"
#include "tests/support/folder.h"
#include "tests/support/mesh_files.h"
#include "tests/support/portable.h"

using namespace alcap;
using mesh_files::encode;
using mesh_files::raw;
namespace fs = std::filesystem;

namespace {

// Expects a FileError on that line (0: the file as a whole) whose message holds all the given parts.
void refused(const std::string& bytes, std::int64_t line, std::vector<std::string> parts, const char* format = "") {
  INFO(bytes);
  try {
    const MeshFile m = read_mesh_from_memory(bytes, format);
    FAIL_CHECK("was read: " << m.V.rows() << " vertices, " << m.F.rows() << " faces");
  } catch (const FileError& error) {
    const std::string what = error.what();
    INFO(what);
    CHECK(error.line() == line);
    CHECK(error.path() == "<memory>");
    for (const auto& part : parts) CHECK_MESSAGE(what.find(part) != std::string::npos, part);
  }
}

void tetrahedron(Positions<double>& V, Faces& F) {
  V.resize(4, 3);
  V << 0, 0, 0, 1.25, 0, 0, 0, 1.5, 0.125, 0, 0, 12;
  F.resize(4, 3);
  F << 0, 1, 2, 0, 3, 1, 1, 3, 2, 2, 3, 0;  // in the order in which STL numbers them
}

// What holds for everything that a reader returns.
bool acceptable(const MeshFile& m, std::size_t bytes) {
  const auto most = static_cast<Eigen::Index>(bytes);
  return m.V.rows() > 0 && m.V.rows() <= most && m.F.rows() > 0 && m.F.rows() <= most && m.V.allFinite() &&
         m.F.minCoeff() >= 0 && m.F.maxCoeff() < m.V.rows() &&
         (m.polygon_of.empty() || m.polygon_of.size() == static_cast<std::size_t>(m.F.rows()));
}

std::string slurp(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

TEST_CASE("what is no number is never another number") {
  for (const char* token :
       {"1.5abc", "nan", "NaN", "-nan", "inf", "-Infinity", "1e999", "-1e999", "0x10",    "1,5", "1.5.2", "--1",
        "+-1",    "1e",  "1e+", "-",    "+",   ".",         "1d5",   "1_0",    "1.#QNAN", "one", "\x01",  "1\\2"}) {
    CAPTURE(token);
    for (int column = 0; column < 3; ++column) {
      std::string row;
      for (int c = 0; c < 3; ++c) row += " " + std::string(c == column ? token : "1");
      const std::string shown = token == std::string("\x01") ? "'\\x01'" : "'" + std::string(token) + "'";
      refused("v 0 0 0\nv 1 0 0\nv" + row + "\nf 1 2 3\n", 3, {shown, "vertex 2", "<memory>:3"});
      refused("OFF\n3 1 0\n0 0 0\n1 0 0\n" + row + "\n3 0 1 2\n", 5, {shown, "vertex 2"});
      refused(
          "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face "
          "1\n"
          "property list uchar int vertex_index\nend_header\n0 0 0\n1 0 0\n" +
              row + "\n3 0 1 2\n",
          12, {shown, "vertex 2"});
      refused("solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex" + row +
                  "\nendloop\nendfacet\nendsolid\n",
              6, {shown, "corner 2 of face 0"});
    }
  }
  for (const char* token : {"1.0", "1.5", "1x", "1e0", "", "99999999999999999999", "0x1", "1,"}) {
    refused("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 2 " + std::string(token) + "\n", 6, {"face 0"});
  }
  refused("v 0 0 0\nv 1,5 0 0\n", 2, {"decimal point"});
  refused("v 0 0 0\nv 1e999 0 0\n", 2, {"too large"});
  refused("v 0 0 0\nv 0 nan 0\nv 0 1 0\nf 1 2 3\n", 2, {"not finite"});
  refused("v 0 0 0\n\n# c\n\nv 0 1\nv 0 0 1\nf 1 2 3\n", 5, {"line ends", "vertex 1"});
}

TEST_CASE("numbers that are not finite in binary files name their vertex") {
  Positions<double> V;
  Faces F;
  tetrahedron(V, F);
  V(2, 1) = std::numeric_limits<double>::quiet_NaN();
  for (const char* name : {"ply little endian", "ply big endian"})
    refused(encode(name, V, F), 0, {"coordinate of vertex 2", "byte"});
  refused(encode("stl binary", V, F), 0, {"corner 2 of face 0", "finite", "byte"});
  V(2, 1) = std::numeric_limits<double>::infinity();
  refused(encode("ply big endian", V, F), 0, {"vertex 2"});
}

TEST_CASE("an index without its vertex is named with its face") {
  Positions<double> V;
  Faces F;
  tetrahedron(V, F);
  F(2, 1) = 4;
  refused(encode("obj", V, F), 7, {"face 2", "vertex 4", "4 vertices"});
  refused(encode("off", V, F), 9, {"face 2", "vertex 4"});
  refused(encode("ply ascii", V, F), 17, {"face 2", "vertex 4"});
  refused(encode("ply little endian", V, F), 0, {"face 2", "vertex 4", "byte"});
  F(2, 1) = -1;
  refused(encode("off", V, F), 9, {"face 2", "vertex -1"});
  refused(encode("ply big endian", V, F), 0, {"face 2", "vertex -1", "byte"});
  const std::string v = "v 0 0 0\nv 1 0 0\nv 1 1 0\n";
  refused(v + "f 1 2 0\n", 4, {"face 0", "counts from 1"});
  refused(v + "f 1 2 -4\n", 4, {"face 0"});
  refused(v + "f 1 2 3\nf 1 2 9999999999\n", 5, {"face 1"});
  refused(v + "f 1 2\n", 4, {"face 0", "2 corners"});
  refused(v + "f 1/x 2 3\n", 4, {"'1/x'"});
  refused(v + "f 1 2 3 # c\nf 1 2 3.5\n", 5, {"'3.5'"});
}

TEST_CASE("files that hold no surface say what is missing") {
  refused("", 0, {"empty"});
  refused("   \n", 0, {"known mesh format"});
  refused("v 0 0 0\nv 1 0 0\n", 0, {"2 vertices", "no faces"});
  refused("# nothing\n", 0, {"no vertices"}, "obj");
  refused("OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n", 0, {"no faces"});
  refused("OFF\n0 0 0\n", 0, {"no vertices"});
  refused(
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 "
      "0\n",
      0, {"no faces"});
  refused("solid\nendsolid\n", 0, {"no vertices"});
}

TEST_CASE("OBJ, OFF and PLY refuse what they cannot mean") {
  refused("v 0 0 0\nV 1 0 0\n", 2, {"'V'"});
  refused("3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", 1, {"word OFF", "'3'"}, "off");
  refused("4OFF\n3 1 0\n", 1, {"'4OFF'"});
  refused("nOFF\n3\n3 1 0\n", 1, {"'nOFF'"});
  refused("OFF BINARY\n3 1 0\n", 0, {"cut"});
  refused("OFF\n3 1 0\n0 0 0 1 0 0\n0 1 0\n3 0 1 2 7\n", 6, {"file ends", "face 0"});
  refused("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 2 1 0\n", 7, {"line of its own"});
  refused("OFF\n-3 1 0\n", 0, {"-3 vertices"});
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string points = "0 0 0\n1 0 0\n0 1 0\n";
  const std::string list = "property list uchar int vertex_indices\n";
  refused(ply + "element tristrips 1\n" + list + "end_header\n" + points + "3 0 1 2\n", 0, {"triangle strips"});
  refused(ply + "element face 1\nproperty int vertex_indices\nend_header\n" + points + "3\n", 0, {"vertex_indices"});
  refused(ply + "element face 1\n" + list + "end_header\n" + points + "3 0 1 2 7\n", 13, {"more values"});
  refused(ply + "element face 1\n" + list + "end_header\n" + points + "3 0 1\n", 13, {"line ends"});
  refused(ply + "element face 1\n" + list + "end_header\n" + points + "-3 0 1 2\n", 13, {"-3 corners"});
  refused(ply + "element face 1\n" + list + "end_header\n" + points + "3 0 1 2\n3 0 1 2\n", 14, {"more behind"});
  refused(ply + "element face 1\n" + list + list + "end_header\n", 9, {"twice"});
  refused(ply + "element nothing 9999999999999\nend_header\n" + points, 0, {"no properties"});
  refused(ply + "property half w\n", 7, {"'half'"});
  refused(ply + "property list float int ring\n", 7, {"whole-number type"});
  refused("ply\nformat ascii 1.0\nelement vertex -4\n", 3, {"-4 elements 'vertex'"});
  refused(ply + "property list char int ring\nend_header\n0 0 0 -2\n1 0 0 0\n0 1 0 0\n", 9, {"'ring'", "-2 values"});
  refused("ply\nformat ascii 2.0\n", 2, {"version"});
  refused("ply\nformat utf8 1.0\n", 2, {"'utf8'"});
  refused("ply\nelement vertex 0\nend_header\n", 0, {"format"});
  refused("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nend_header\n0 0\n1 0\n1 1\n", 0,
          {"'z'"});
  refused("solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nvertex 0 1 0\nendloop\n", 7,
          {"endloop"});
}

TEST_CASE("a header that lies costs nothing") {
  for (const std::string n : {"1000000", "2000000000", "99999999999", "999999999999999999"}) {
    refused("OFF\n" + n + " 1 0\n0 0 0\n", 0, {n, "vertices"});
    refused("OFF\n3 " + n + " 0\n0 0 0\n1 0 0\n1 1 0\n", 0, {n, "faces"});
    for (const char* encoding : {"ascii", "binary_little_endian"}) {
      const std::string start = "ply\nformat " + std::string(encoding) + " 1.0\nelement ";
      refused(start + "vertex " + n + "\nproperty float x\nproperty float y\nproperty float z\nend_header\nabc\n", 0,
              {n});
      refused(start + "junk " + n + "\nproperty list uchar float x\nend_header\nabc\n", 0, {n});
    }
  }
  std::string stl(80, 'x');
  refused(stl + raw(std::uint32_t{4000000000}) + "abc", 0, {"200000000084"}, "stl");
  refused("OFF\n3 1 0\n0 0 0\n1 0 0\n1 1 0\n2000000000 0 1 2\n", 6, {"2000000000"});
}

TEST_CASE("every prefix of a file is an error, or a mesh where a prefix is a file") {
  Positions<double> V;
  Faces F;
  tetrahedron(V, F);
  for (const auto& encoding : mesh_files::encodings) {
    CAPTURE(encoding.name);
    const std::string whole = encode(encoding.name, V, F);
    const std::size_t last_line = whole.rfind('\n', whole.size() - 2) + 1;
    for (const char* format : {"", encoding.format}) {
      for (std::size_t length = 0; length < whole.size(); ++length) {
        CAPTURE(length);
        try {
          // A copy on the heap, so that the sanitizer sees a read behind the end.
          const std::vector<char> prefix(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length));
          const MeshFile m = read_mesh_from_memory({prefix.data(), prefix.size()}, format);
          CHECK_FALSE(encoding.binary);
          REQUIRE(acceptable(m, length));
          // Whole triangles without 'endsolid': read as far as they go, with a remark.
          const bool told = !m.remarks.empty();
          if (encoding.counted) CHECK((told || length >= last_line));
          CHECK(m.V == V.topRows(told ? m.V.rows() : V.rows()));
          const Eigen::Index surely = m.F.rows() - 1;  // the last index may have lost digits
          CHECK(m.F.topRows(surely) == F.topRows(surely));
        } catch (const FileError&) {
          CHECK(true);
        }
      }
    }
  }
}

TEST_CASE("no change of one byte does harm") {
  Positions<double> V;
  Faces F;
  tetrahedron(V, F);
  std::mt19937_64 random(7);
  const std::string telling = "0123456789-+.eE/#\\ \n\r\tvfn\"";
  for (const auto& encoding : mesh_files::encodings) {
    CAPTURE(encoding.name);
    const std::string whole = encode(encoding.name, V, F);
    int read = 0, errors = 0;
    for (int trial = 0; trial < 20000; ++trial) {
      std::vector<char> bytes(whole.begin(), whole.end());
      const bool any = random() % 2 == 0;
      bytes[random() % bytes.size()] = any ? static_cast<char>(random() % 256) : telling[random() % telling.size()];
      try {
        const MeshFile m = read_mesh_from_memory({bytes.data(), bytes.size()}, trial % 2 == 0 ? "" : encoding.format);
        REQUIRE(acceptable(m, bytes.size()));
        ++read;
      } catch (const FileError&) {
        ++errors;
      }
    }
    CHECK(read > 100);  // the mutations reach both sides
    CHECK(errors > 100);
  }
}

TEST_CASE("polygons that no algorithm likes end in time") {
  std::mt19937_64 random(9);
  std::string text, face = "f";
  for (int i = 1; i <= 9000; ++i) {
    text += mesh_files::print("v %d %d 0\n", static_cast<int>(random() % 1000), static_cast<int>(random() % 1000));
    face += " " + std::to_string(i);
  }
  try {
    const MeshFile m = read_mesh_from_memory(text + face + "\n");
    CHECK(m.F.rows() == 8998);
  } catch (const FileError& error) {
    CHECK(error.line() == 9001);
  }
  for (int i = 0; i < 2000; ++i) face += " 1 2 3";
  refused(text + face + "\n", 9001, {"corners", "not convex"});
}

TEST_CASE("paths that are no mesh files") {
  test::Folder folder;
  const auto refused_path = [](const fs::path& path, const std::string& part) {
    try {
      std::ignore = read_mesh(path);
      FAIL_CHECK("was read");
    } catch (const FileError& error) {
      INFO(error.what());
      CHECK(error.path() == path.string());
      CHECK(std::string(error.what()).find(part) != std::string::npos);
    }
  };
  const auto put = [&](const char* name, const std::string& bytes) {
    std::ofstream(folder.path / name, std::ios::binary) << bytes;
    return folder.path / name;
  };
  refused_path(folder.path, "folder");
  refused_path(folder.path / "none.obj", "no such file");
  refused_path(put("empty.obj", "").string(), "empty");
  refused_path("/dev/null", "device");
  refused_path(put("a.ply", "\x1F\x8B\x08"), "gzip");
  refused_path(put("a.obj", "hello"), "'hello'");  // by extension: the OBJ reader says what is wrong
  refused_path(put("a.doc", "hello"), "known mesh format");
  CHECK_THROWS_AS(std::ignore = read_mesh_from_memory("v 0 0 0", "fbx"), OptionError);
}

TEST_CASE("a pipe is read like a file" * doctest::skip(test::portable)) {
  test::Folder folder;
  const fs::path pipe = folder.path / "pipe";
  REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
  std::thread writer([&] { std::ofstream(pipe) << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"; });
  const MeshFile m = read_mesh(pipe);
  writer.join();
  CHECK(m.V.rows() == 3);
  CHECK(m.F.rows() == 1);
}

TEST_CASE("writers refuse what readers would refuse, and leave nothing behind") {
  test::Folder folder;
  Positions<double> V;
  Faces F;
  tetrahedron(V, F);
  CHECK_THROWS_AS(write_mesh(folder.path / "a.stl", V, F), FileError);
  CHECK_THROWS_AS(write_mesh(folder.path / "a", V, F), FileError);
  CHECK_THROWS_AS(write_mesh(folder.path / "no" / "a.obj", V, F), FileError);
  CHECK_THROWS_AS(write_mesh(folder.path / "a.obj", V, Faces(0, 3)), MeshError);
  Faces wrong = F;
  wrong(1, 1) = 4;
  CHECK_THROWS_AS(write_mesh(folder.path / "a.obj", V, wrong), MeshError);
  V(1, 1) = std::numeric_limits<double>::infinity();
  CHECK_THROWS_AS(write_mesh(folder.path / "a.obj", V, F), MeshError);
  CHECK(folder.names().size() == 0);
}

TEST_CASE("an atomic file appears at commit, complete, or not at all") {
  test::Folder folder;
  const fs::path target = folder.path / "out.txt";
  {
    detail::AtomicFile file(target);
    file.write("lost");
    CHECK_FALSE(fs::exists(target));
    CHECK(folder.names().size() == 1);
  }
  CHECK(folder.names().size() == 0);
  std::string large(3 << 20, 'x');
  for (const std::string& text : {std::string("first"), large}) {
    detail::AtomicFile file(target);
    file.write(text);
    file.write("!");
    CHECK(file.size() == static_cast<std::int64_t>(text.size()) + 1);
    file.commit();
    CHECK(slurp(target) == text + "!");
    CHECK(folder.names().size() == 1);
    CHECK_THROWS_AS(file.commit(), FileError);
  }
  fs::permissions(target, fs::perms::owner_read | fs::perms::owner_write);
  fs::create_symlink("out.txt", folder.path / "link");
  detail::AtomicFile through(folder.path / "link");
  through.write("new");
  through.commit();
  CHECK(fs::is_symlink(folder.path / "link"));
  CHECK(slurp(target) == "new");
  CHECK(fs::status(target).permissions() == (fs::perms::owner_read | fs::perms::owner_write));
  fs::create_symlink("nothing.txt", folder.path / "lost");
  CHECK_THROWS_AS(detail::AtomicFile{folder.path / "lost"}, FileError);
  fs::remove(folder.path / "lost");
  CHECK_THROWS_AS(detail::AtomicFile{folder.path}, FileError);
  detail::AtomicFile nowhere("/dev/null");  // no regular file: written directly
  nowhere.write("x");
  nowhere.commit();
  CHECK(folder.names().size() == 2);
}

TEST_CASE("headers of thousands of elements or properties are read or refused, and none is compared with all others") {
  const auto header = [](int elements, int properties) {
    std::string text =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
    for (int k = 0; k < properties; ++k) text += "property float p" + std::to_string(k) + "\n";
    text += "element face 1\nproperty list uchar int vertex_indices\n";
    for (int k = 0; k < elements; ++k) text += "element e" + std::to_string(k) + " 0\nproperty int i\n";
    return text + "end_header\n";
  };
  std::string body;
  for (const char* point : {"0 0 0", "1 0 0", "0 1 0"}) {
    body += point;
    for (int k = 0; k < 9000; ++k) body += " 1";
    body += "\n";
  }
  CHECK(read_mesh_from_memory(header(9000, 9000) + body + "3 0 1 2\n", "").F.rows() == 1);
  refused(header(60'000, 0), 20'005, {"more than 10000 elements"});
  refused(header(0, 60'000), 10'004, {"more than 10000 properties"});
}
