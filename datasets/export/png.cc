#include <utility>

#include "datasets/export/export.h"
#include "datasets/export/parts.h"
#include "datasets/report/cell_picture.h"
#include "datasets/report/draw_map.h"

namespace cairn::datasets {
namespace {

void WriteLayers(const Blob& map, FolderWriter* writer) {
  using report::MapLayer;
  for (const auto& [layer, name] :
       {std::pair(MapLayer::kProbability, "map.png"), std::pair(MapLayer::kMostLikely, "most_likely.png"),
        std::pair(MapLayer::kDifference, "difference.png"), std::pair(MapLayer::kDynamic, "dynamic.png")}) {
    if (const auto picture = report::PictureOf(map, layer))
      writer->Write(name, report::CellsRaster(*picture).Png());
  }
}

}  // namespace

Written ExportPng(const Blob& result, const std::string& folder, bool replace) {
  FolderWriter writer(folder, replace);
  if (IsGridMap(result))
    WriteLayers(result, &writer);
  else
    writer.Write("map.png", DrawMapPng(result, nullptr, nullptr));
  return writer.Finish();
}

}  // namespace cairn::datasets
