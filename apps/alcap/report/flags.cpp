// SPDX-License-Identifier: MIT
#include "apps/alcap/report/flags.h"

#include <array>
#include <utility>

namespace alcap::app {
namespace {

using Row = std::pair<std::string_view, std::string_view>;

// What messages of the library name, and what does it on the command line.
constexpr auto words = std::to_array<Row>({
    {"Repair::weld", "--repair weld"},  // before the longer ones that begin with it: what follows stays
    {"Repair::degenerate", "--repair degenerate"},
    {"Repair::duplicates", "--repair duplicates"},
    {"Repair::split", "--repair split"},
    {"Repair::automatic", "--repair auto"},
    {"Repair::orient", "--repair orient"},
    {"Repair::mollify", "--repair mollify"},
    {"repair_weld()", "--repair weld"},
    {"repair_orientation()", "--repair orient"},
    {"EigenOptions::solver", "--solver"},
    {"the solver '", "--solver '"},
    {"EigenOptions::method", "--method"},
    {"EigenOptions::max_iterations", "--max-iterations"},
    {"EigenOptions::tolerance", "--tolerance"},
    {"EigenOptions::prove_smallest 'never'", "--no-prove"},  // before the shorter one
    {"EigenOptions::prove_smallest", "--prove"},
    {"GlobalOptions::detail", "--detail"},
    {"GlobalOptions::max_iterations", "--connection-iterations"},
    {"GlobalOptions::tolerance", "--connection-tolerance"},
    {"DesignRunOptions::solver", "--solver"},
    {"DistributedOptions::max_iterations", "--max-iterations"},
    {"DistributedOptions::tolerance", "--tolerance"},
    {"DistributedOptions::prove_smallest", "--prove"},
});

// Fields that an OptionError names. The field "s" is --energy where fields are solved for, "name" that of a backend.
constexpr auto fields = std::to_array<Row>({
    {"n", "-n"},
    {"s", "--energy"},
    {"cones", "--cone"},
    {"detail", "--detail"},
    {"guidance_weight", "--guidance"},
    {"tolerance", "--tolerance"},
    {"tolerances.singularity_degrees", "--tolerance-of singularity"},
    {"tolerances.fixed_degrees", "--tolerance-of fixed"},
    {"tolerances.stroke_degrees", "--tolerance-of stroke"},
    {"tolerances.boundary_degrees", "--tolerance-of boundary"},
    {"tolerances.cone_degrees", "--tolerance-of cone"},
    {"tolerances.fixed_value", "--tolerance-of fixed-value"},
    {"tolerances.pin_length", "--tolerance-of pin"},
    {"modes", "--modes"},
    {"count", "--modes"},
    {"solver", "--solver"},
    {"name", "--solver"},
    {"format", "--input-format"},
    {"threads", "--threads"},
    {"jobs", "--jobs"},
    {"triangulation", "--triangulation"},
    {"min_angle", "--min-angle"},
    {"angle_tolerance", "--angle-tolerance"},
    {"tan_cap", "--tan-cap"},
    {"balance_cones", "--cones"},
    {"loop_index", "--loop-index"},
    {"generator_holonomy", "--holonomy"},
    {"t", "--t"},
    {"weight", "--align-weight"},
    {"spacing", "--curve-spacing"},
    {"error", "--sizing-error"},
    {"smallest", "--sizing-range"},
    {"largest", "--sizing-range"},
    {"growth", "--sizing-growth"},
});

}  // namespace

std::string in_flags(std::string message) {
  for (const auto& [word, flag] : words) {
    for (std::size_t at = message.find(word); at != std::string::npos; at = message.find(word, at + flag.size())) {
      message.replace(at, word.size(), flag);
    }
  }
  return message;
}

std::string_view flag_of(std::string_view field) {
  for (const auto& [name, flag] : fields) {
    if (name == field) return flag;
  }
  return {};
}

}  // namespace alcap::app
