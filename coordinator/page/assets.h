// The files of assets/, which the program holds: the pages load nothing from elsewhere.
#pragma once

#include <span>
#include <string_view>

namespace cairn::page {

struct Asset {
  std::string_view name, type, bytes;
};

std::span<const Asset> Assets();
// Aborts where there is none of that name.
std::string_view AssetText(std::string_view name);

}  // namespace cairn::page
