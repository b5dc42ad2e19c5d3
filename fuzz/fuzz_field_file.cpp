// SPDX-License-Identifier: MIT
//
// Any bytes are a field file or a FileError, and so for feature edges, edge lengths and targets of a connection.
#include <sys/mman.h>
#include <unistd.h>

#include <string>

#include "alcap/design_file.h"
#include "alcap/errors.h"
#include "alcap/mesh_io.h"
#include "alcap/output.h"
#include "fuzz/input.h"

namespace {

/// A file in memory that has a name as long as this lives.
class MemoryFile {
 public:
  MemoryFile(const std::uint8_t* data, std::size_t size) : descriptor_(::memfd_create("fuzz", MFD_CLOEXEC)) {
    while (size > 0) {
      const ssize_t written = ::write(descriptor_, data, size);
      alcap::fuzz::demand(written > 0, "memory takes the file");
      data += written;
      size -= static_cast<std::size_t>(written);
    }
  }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  ~MemoryFile() { ::close(descriptor_); }
  [[nodiscard]] std::string path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

 private:
  int descriptor_;
};

void read_fields(const std::string& path) {
  const alcap::FieldFile f = alcap::read_field(path);
  alcap::fuzz::demand(f.field.n >= 1 && f.field.u.size() == f.V.rows(), "a value per vertex");
  alcap::fuzz::demand(f.field.u.allFinite() && f.V.allFinite(), "values are finite");
  alcap::fuzz::demand(f.F.minCoeff() >= 0 && f.F.maxCoeff() < f.V.rows(), "faces name vertices");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace alcap;
  const MemoryFile file(data, size);
  const MeshData mesh = icosphere(0);
  const auto attempt = [](const auto& read) {
    try {
      read();
    } catch (const FileError&) {
    } catch (const OptionError&) {
    }
  };
  attempt([&] { read_fields(file.path()); });
  attempt([&] {
    for (const auto& edge : read_sharp(mesh.F, file.path()))
      fuzz::demand(edge[0] >= 0 && edge[1] < mesh.V.rows() && edge[0] != edge[1], "edges name vertices");
  });
  attempt([&] { (void)read_connection_target(file.path()); });
  return 0;
}
