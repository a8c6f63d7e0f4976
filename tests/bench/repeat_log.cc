// A log of one robot with a laser and poses, taken many times over: its scans and poses again and again, each
// time later.
//   repeat_log LOG.h5 TIMES OUT.h5
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "schema/store/blob_file.h"
#include "tests/bench/bench_main.h"

namespace cairn {
namespace {

// `times` copies of rows one after the other; where they are times, each copy `later_s` after the one before.
Array Repeated(const Array& rows, int times, double later_s) {
  const auto values = rows.As<double>();
  std::vector<double> all;
  all.reserve(values.size() * static_cast<std::size_t>(times));
  for (int k = 0; k < times; ++k) {
    for (const double value : values) all.push_back(value + k * later_s);
  }
  Shape shape = rows.shape();
  shape[0] *= times;
  return Array::Of<double>(shape, all);
}

int Main(const std::vector<std::string>& args) {
  if (args.size() != 3) throw InputError("it takes LOG.h5 TIMES OUT.h5");
  const int times = std::atoi(args[1].c_str());
  if (times < 1) throw InputError("TIMES is a number of copies, not '" + args[1] + "'");
  const auto file = ReadBlobFileWithoutTruth(args[0]);
  if (!file.ok()) throw InputError(file.status().message());
  const Blob& log = file.value().blob;
  const auto time = log.Get<double>("robot/0/poses/time_s");  // scans have poses, before and after
  const double later_s = time.back() - time.front() + 1;
  Blob out;
  out.Put("robots", log.at("robots"));
  for (const char* group : {"robot/0/poses/", "robot/0/laser/"}) {
    const Blob fields = log.Sub(group);
    for (const auto& [name, array] : fields.fields()) {
      const bool rows = name == "range_m" || name == "time_s" || group == std::string("robot/0/poses/");
      out.Put(group + name, rows ? Repeated(array, times, name == "time_s" ? later_s : 0) : array);
    }
  }
  const Status status = WriteBlobFile(args[2], "log", out);
  if (!status.ok()) throw InputError(status.message());
  return 0;
}

}  // namespace
}  // namespace cairn

int main(int argc, char** argv) { return cairn::BenchMain("repeat_log", cairn::Main, argc, argv); }
