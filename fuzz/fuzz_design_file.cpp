// SPDX-License-Identifier: MIT
//
// Any text is a design or a FileError, and a design is written and read back as the same one.
#include "alcap/design_file.h"
#include "alcap/errors.h"
#include "fuzz/input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace alcap;
  try {
    const DesignFile design = parse_design({reinterpret_cast<const char*>(data), size});
    const std::string text = design_text(design);
    fuzz::demand(design_text(parse_design(text)) == text, "a design is read back as it was");
  } catch (const FileError&) {
  } catch (const OptionError&) {
  }
  return 0;
}
