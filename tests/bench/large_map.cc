// A grid map of so many known cells with one robot's path, as a large building leaves it: walls every few
// metres, probabilities that differ from cell to cell, a path that winds through all of it.
//   large_map MILLIONS_OF_CELLS POSES OUT.h5
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "schema/store/blob_file.h"
#include "tests/bench/bench_main.h"

namespace cairn {
namespace {

constexpr double kCell_m = 0.05;

// 0 to 1, of a place alone.
double Noise(std::uint64_t n) {
  n = (n ^ (n >> 31)) * 0x9e3779b97f4a7c15ULL;
  n = (n ^ (n >> 27)) * 0xbf58476d1ce4e5b9ULL;
  return static_cast<double>((n ^ (n >> 33)) >> 11) / static_cast<double>(1ULL << 53);
}

int Main(const std::vector<std::string>& args) {
  if (args.size() != 3) throw InputError("it takes MILLIONS_OF_CELLS POSES OUT.h5");
  const double cells = 1e6 * std::atof(args[0].c_str());
  const int poses = std::atoi(args[1].c_str());
  if (cells < 100 || poses < 2) throw InputError("too few cells or poses");
  const auto nx = static_cast<std::int64_t>(std::sqrt(cells * 1.25)),
             ny = static_cast<std::int64_t>(cells / static_cast<double>(nx));
  std::vector<double> probability(static_cast<std::size_t>(nx * ny));
  for (std::int64_t y = 0; y < ny; ++y)
    for (std::int64_t x = 0; x < nx; ++x) {
      const auto at = static_cast<std::size_t>(y * nx + x);
      const bool wall = (x % 120 < 3 && y % 120 > 24) || (y % 160 < 3 && x % 160 > 24);
      probability[at] = wall ? 0.7 + 0.3 * Noise(at) : 0.3 * Noise(at);
    }
  std::vector<double> time_s, x_m, y_m, heading_rad;
  for (int i = 0; i < poses; ++i) {
    const double part = static_cast<double>(i) / poses, turns = 40 * 2 * M_PI * part;
    const auto jitter = [&](int of) { return 0.05 * (Noise(static_cast<std::uint64_t>(3 * i + of)) - 0.5); };
    time_s.push_back(0.1 * i);
    x_m.push_back(kCell_m * static_cast<double>(nx) * (0.5 + 0.45 * std::sin(turns)) + jitter(0));
    y_m.push_back(kCell_m * static_cast<double>(ny) * (0.05 + 0.9 * part + 0.02 * std::cos(7 * turns)) +
                  jitter(1));
    heading_rad.push_back(std::remainder(turns, 2 * M_PI));
  }
  Blob map;
  map.Put("map/grid/probability", Array::Of<double>({ny, nx}, probability));
  map.PutScalar("map/grid/origin_x_m", 0.0);
  map.PutScalar("map/grid/origin_y_m", 0.0);
  map.PutScalar("map/grid/cell_m", kCell_m);
  map.Put("robots", Array::Texts({"robot 0"}));
  map.PutVector("robot/0/laser/time_s", time_s);
  map.PutVector("robot/0/laser/x_m", x_m);
  map.PutVector("robot/0/laser/y_m", y_m);
  map.PutVector("robot/0/laser/heading_rad", heading_rad);
  map.PutVector("robot/0/laser/held_out", std::vector<std::uint8_t>(time_s.size()));
  const Status status = WriteBlobFile(args[2], "grid_map", map);
  if (!status.ok()) throw InputError(status.message());
  return 0;
}

}  // namespace
}  // namespace cairn

int main(int argc, char** argv) { return cairn::BenchMain("large_map", cairn::Main, argc, argv); }
