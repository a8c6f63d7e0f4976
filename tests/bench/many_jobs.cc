// Submits many jobs at once, which nobody plans or reads before: for page_rates.py.
//   many_jobs ENDPOINT COUNT
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
  for (int i = 1; i <= count; ++i) {
    const Result<wire::JobInfo> job = client.value().Submit(JobOf(i), inputs);
    if (!job.ok()) throw InputError(job.status().message());
  }
  std::printf("%d jobs\n", count);
  return 0;
}

}  // namespace
}  // namespace cairn

int main(int argc, char** argv) { return cairn::BenchMain("many_jobs", cairn::Main, argc, argv); }
