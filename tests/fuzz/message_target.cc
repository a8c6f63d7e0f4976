#include "schema/wire/codec.h"
#include "tests/fuzz/frames.h"
#include "tests/fuzz/targets.h"

namespace cairn::fuzz {
namespace {

Outcome Run(std::span<const std::uint8_t> bytes) {
  const Result<wire::Message> read = wire::Decode(CutIntoFrames(std::as_bytes(bytes)));
  if (!read.ok()) return Outcome::kRefused;
  const wire::Frames frames = wire::Encode(read.value());
  std::vector<std::span<const std::byte>> views = {std::as_bytes(std::span(frames.envelope))};
  for (const Array& array : frames.arrays) views.push_back(array.bytes());
  const Result<wire::Message> again = wire::Decode(views);
  CAIRN_DEMAND(again.ok(), again.status().message());
  CAIRN_DEMAND(again.value().envelope.body_case() == read.value().envelope.body_case(),
               "the kind did not come back");
  CAIRN_DEMAND(again.value().blobs.size() == read.value().blobs.size(), "a blob did not come back");
  for (std::size_t i = 0; i < read.value().blobs.size(); ++i) {
    const wire::NamedBlob& named = again.value().blobs[i];
    CAIRN_DEMAND(named.hash == read.value().blobs[i].hash && named.blob->ContentHash() == named.hash,
                 "another blob came back");
  }
  return Outcome::kAccepted;
}

std::vector<Bytes> Seeds() {
  Blob blob;
  blob.PutVector<double>("x_m", {1, 2, 3});
  blob.Put("empty", Array::Of<float>({2, 0}, std::vector<float>()));
  blob.Put("names", Array::Texts({"a", "Grüße"}));
  wire::Message data, done, assign;
  data.envelope.mutable_blob();
  data.blobs = {wire::NameBlob(std::make_shared<const Blob>(blob))};
  done.envelope.mutable_done()->mutable_key()->set_job("museum");
  done.blobs = {data.blobs[0], data.blobs[0]};
  wire::Assign& task = *assign.envelope.mutable_assign();
  task.mutable_stage()->set_pipeline("landmark_map");
  (*task.mutable_inputs())["log"] = data.blobs[0].hash.Binary();
  task.add_partials("short");
  return {JoinFrames(data), JoinFrames(done), JoinFrames(assign)};
}

}  // namespace

Target MessageTarget() { return {"message", Run, Seeds, 20000}; }

}  // namespace cairn::fuzz
