#include "datasets/export.h"
#include "datasets/export_parts.h"
#include "datasets/report/draw_map.h"

namespace cairn::datasets {

Written ExportPng(const Blob& result, const std::string& folder, bool replace) {
  const std::string png = DrawMapPng(result, nullptr, nullptr);
  FolderWriter writer(folder, replace);
  writer.Write("map.png", png);
  return writer.Finish();
}

}  // namespace cairn::datasets
