// large_log FILE MB SEED: a log of about so many megabytes that no compression makes smaller, quickly.
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "schema/rng.h"
#include "schema/store/blob_file.h"

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  const auto rows = static_cast<std::size_t>(std::atof(argv[2]) * 1e6 / 24);
  cairn::Rng rng(static_cast<std::uint64_t>(std::atoll(argv[3])));
  std::vector<double> time_s(rows), turn_rad(rows), forward_m(rows);
  for (std::size_t i = 0; i < rows; ++i) {
    time_s[i] = 0.1 * static_cast<double>(i);
    turn_rad[i] = rng.Uniform(-0.02, 0.02);
    forward_m[i] = rng.Uniform(0.02, 0.05);
  }
  cairn::Blob log;
  log.Put("robots", cairn::Array::Texts({"one"}));
  log.PutVector("robot/0/odometry/time_s", time_s);
  log.PutVector("robot/0/odometry/turn_rad", turn_rad);
  log.PutVector("robot/0/odometry/forward_m", forward_m);
  const cairn::Status status = cairn::WriteBlobFile(argv[1], "log", log);
  if (!status.ok()) std::fprintf(stderr, "%s\n", status.message().c_str());
  return status.ok() ? 0 : 1;
}
