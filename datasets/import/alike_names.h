// Names that people may take for one.
#pragma once

#include <string>
#include <vector>

namespace cairn::datasets {

// Of names that differ in the case of their letters (of ASCII) or in zeros alone, which lead a number or
// end the decimals of a name that is one (6 and 6.0): "'DOOR' and 'door' are taken for two landmarks …", the
// first such pair and how many more there are; empty where there is none. `kind`: "landmarks". A name that
// comes again is the same.
std::string WarningOfAlikeNames(const std::vector<std::string>& names, const std::string& kind);

}  // namespace cairn::datasets
