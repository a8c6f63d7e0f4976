// Submits many jobs, one after the other, which nobody plans or reads before: for page_rates.py, and to see
// what each takes the more there are: docs/scale.md.
//   many_jobs ENDPOINT COUNT
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "coordinator/client.h"
#include "tests/bench/bench_main.h"

namespace cairn {
namespace {

proto::Job JobOf(int number) {
  proto::Job job;
  job.set_name("tour-" + std::to_string(number));
  job.set_seed(static_cast<std::uint64_t>(number));
  (*job.mutable_inputs())["log"] = "log.h5";
  proto::Stage& stage = *job.add_stages();
  stage.set_name("landmarks");
  stage.set_pipeline("landmark_map");
  (*stage.mutable_inputs())["log"] = "log";
  return job;
}

int Main(const std::vector<std::string>& args) {
  if (args.size() != 2) throw InputError("it takes ENDPOINT COUNT");
  coordinator::ClientOptions options;
  options.endpoint = args[0];
  options.timeout_s = 60;
  Result<coordinator::Client> client = coordinator::Client::Connect(options);
  if (!client.ok()) throw InputError(client.status().message());
  Blob blob;
  blob.PutScalar("v", 1.0);
  const std::map<std::string, BlobPtr> inputs = {{"log", std::make_shared<const Blob>(std::move(blob))}};
  const int count = std::atoi(args[1].c_str());
  constexpr int kEvery = 1000;
  auto since = std::chrono::steady_clock::now();
  for (int i = 1; i <= count; ++i) {
    const Result<wire::JobInfo> job = client.value().Submit(JobOf(i), inputs);
    if (!job.ok()) throw InputError(job.status().message());
    if (i % kEvery != 0 && i != count) continue;
    const auto now = std::chrono::steady_clock::now();
    const int latest = i % kEvery == 0 ? kEvery : i % kEvery;
    std::printf("%d jobs, the latest %d at %.2f ms each\n", i, latest,
                std::chrono::duration<double, std::milli>(now - since).count() / latest);
    std::fflush(stdout);
    since = now;
  }
  return 0;
}

}  // namespace
}  // namespace cairn

int main(int argc, char** argv) { return cairn::BenchMain("many_jobs", cairn::Main, argc, argv); }
