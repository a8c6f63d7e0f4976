#include "pipelines/forward_map/state.h"

#include "pipelines/common/handed_over.h"

namespace cairn::forward_map {

std::string TilesKey(std::int64_t split) { return "tiles/" + std::to_string(split); }
std::string ScansKey(std::int64_t sensor) { return "scans/" + std::to_string(sensor); }
std::string SliceKey(std::int64_t sensor) { return "slice/" + std::to_string(sensor); }
std::string TilesBlob(std::int64_t split) { return "tiles/" + std::to_string(split); }
std::string SensorBlobName(std::int64_t sensor) { return "sensor/" + std::to_string(sensor); }
std::string ScansBlobName(std::int64_t sensor) { return "scans/" + std::to_string(sensor); }

void MapState::Check(double most_cells) const {
  RequireGrid(box, most_cells);
  RequireSize("occupied", occupied.size(), static_cast<std::size_t>(box.cells()));
  RequireAllWithin("occupied", occupied, std::int64_t{0}, std::int64_t{1});
  constexpr double kLeast_m = 1e-9;
  for (const SensorModel& model : models) {
    RequireWithin("p_hit", model.p_hit, 1e-6, 1 - 1e-6);
    RequireWithin("p_rand", model.p_rand, 1e-9, 1.0);
    RequireWithin("p_lost", model.p_lost, 0.0, 1.0);
    RequireWithin("p_rand and p_lost", model.p_rand + model.p_lost, 0.0, 1.0);
    RequireWithin("sigma_m", model.sigma_m, kLeast_m, kFar_m);
    RequireWithin("no_echo_sigma_m", model.no_echo_m, kLeast_m, kFar_m);
    RequireWithin("z_max_m", model.z_max_m, kLeast_m, kFar_m);
  }
}

MapState MapIn(const GridOptions& options, const Inputs& inputs, const char* blob) {
  MapState map = Read<MapState>(*inputs.Get(blob));
  map.Check(MostCells(options, kBytesOfCell));
  return map;
}

double MapState::CountOccupied() const {
  std::int64_t count = 0;
  for (const std::uint8_t cell : occupied) count += cell;
  return static_cast<double>(count);
}

double MapState::LogPrior(const MapPrior& prior) const {
  std::int64_t unlike = 0;
  for (std::int64_t row = 0; row < box.rows; ++row) {
    for (std::int64_t column = 0; column < box.columns; ++column) {
      const auto at = static_cast<std::size_t>(row * box.columns + column);
      if (column > 0) unlike += occupied[at] != occupied[at - 1] ? 1 : 0;
      if (row > 0) unlike += occupied[at] != occupied[at - static_cast<std::size_t>(box.columns)] ? 1 : 0;
      // The map lies in free space.
      const int rims = (column == 0) + (column + 1 == box.columns) + (row == 0) + (row + 1 == box.rows);
      unlike += occupied[at] * rims;
    }
  }
  return prior.logit * CountOccupied() - prior.smoothness * static_cast<double>(unlike);
}

Blob ToBlob(const std::vector<Proposal>& proposals) {
  std::vector<std::int64_t> cells, end;
  std::vector<double> gain;
  for (const Proposal& proposal : proposals) {
    cells.insert(cells.end(), proposal.cells.begin(), proposal.cells.end());
    end.push_back(static_cast<std::int64_t>(cells.size()));
    gain.push_back(proposal.gain);
  }
  Blob blob;
  blob.PutVector("cell", cells);
  blob.PutVector("end", end);
  blob.PutVector("gain_nats", gain);
  return blob;
}

std::vector<Proposal> ProposalsOf(const Blob& blob) {
  const auto cells = blob.Get<std::int64_t>("cell"), end = blob.Get<std::int64_t>("end");
  const auto gain = blob.Get<double>("gain_nats");
  RequireSize("gain_nats", gain.size(), end.size());
  std::vector<Proposal> proposals;
  std::int64_t first = 0;
  for (std::size_t i = 0; i < end.size(); ++i) {
    RequireWithin("the end of a proposal", end[i], first, static_cast<std::int64_t>(cells.size()));
    proposals.push_back({{cells.begin() + first, cells.begin() + end[i]}, gain[i]});
    first = end[i];
  }
  return proposals;
}

void Apply(const std::vector<Proposal>& proposals, std::size_t count, std::vector<std::uint8_t>* occupied) {
  const auto cells = static_cast<std::int64_t>(occupied->size());
  RequireWithin("the number of proposals", static_cast<std::int64_t>(count), 0,
                static_cast<std::int64_t>(proposals.size()));
  for (std::size_t i = 0; i < count; ++i) {
    RequireAllWithin("a proposal's cell", proposals[i].cells, std::int64_t{0}, cells - 1);
    for (const std::int64_t cell : proposals[i].cells) (*occupied)[static_cast<std::size_t>(cell)] ^= 1;
  }
}

}  // namespace cairn::forward_map
