#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "cli/machines.hpp"

namespace polyglide {

/// What `polyglide catalog` tells about a machine beside its file.
struct CatalogRow {
  ChosenMachine machine;
  std::string motion;        ///< "3T1R", at a generic posture
  std::string axes;          ///< "XYZA"
  std::string architecture;  ///< "3-UPS+UP"
};

/// What is looked for; what is left out fits every machine.
struct CatalogQuery {
  std::string motion;      ///< a pattern "3T1R", or letters of XYZABC
  std::string drives;      ///< how many, in digits
  std::string drive_type;  ///< "prismatic" or "revolute": all drives
  std::string limb;        ///< "PUU"
  std::string search;      ///< words, all of them in name, title, source, about
};

/// Declares --motion, --drives, --drive-type, --limb and --search.
void add_search_options(CLI::App& app, CatalogQuery& query);

/// Puts the query's words into one form and refuses those that cannot fit any machine.
/// @throws InputError with every mistake: a motion that is none, an unknown type of drive,
///         a limb that is not made of joint letters.
void check_query(CatalogQuery& query);

/// Does the machine fit? Letters of motion fit in any order, and A and B stand for each other
/// when they are the only rotation: which horizontal axis it is depends on how the machine is
/// turned. A limb fits when it stands in the architecture as a whole word.
[[nodiscard]] bool matches(const CatalogQuery& query, const CatalogRow& row);

/// Why nothing was found, in one line: the first condition that no machine of `rows` fits on
/// its own, with the nearest word that one does, or that no machine fits all of them together.
[[nodiscard]] std::string no_match(const CatalogQuery& query, const std::vector<CatalogRow>& rows);

/// "prismatic" or "revolute" for every drive, in the order of the file: whether its coordinate
/// is a length or an angle.
[[nodiscard]] std::vector<std::string> drive_kinds(const Mechanism& mechanism);

}  // namespace polyglide
