// What is exported as MCAP, read back by the reader of bags.
#include <cmath>
#include <cstring>
#include <map>

#include "datasets/bag/container.h"
#include "datasets/export/export.h"
#include "datasets/export/foxglove.pb.h"
#include "datasets/export/mcap_file.h"
#include "datasets/testing.h"
#include "datasets/testing_result.h"

namespace cairn::datasets {
namespace {

struct Received {
  std::int64_t time_ns = 0;
  std::string bytes;
};

struct ReadBack {
  std::map<std::string, std::string> types;  // by topic
  std::map<std::string, std::vector<Received>> messages;
  std::vector<std::string> remarks;

  template <class Message>
  Message Get(const std::string& topic, std::size_t i = 0) const {
    Message message;
    EXPECT_EQ(types.at(topic), message.GetDescriptor()->full_name());
    EXPECT_TRUE(message.ParseFromString(messages.at(topic).at(i).bytes)) << topic;
    return message;
  }
};

ReadBack ReadMcap(const std::string& path) {
  const auto file = bag::OpenContainer(path);
  ReadBack back;
  back.remarks = file->remarks();
  for (const bag::Channel& channel : file->channels()) {
    back.types[channel.topic] = channel.type;
    EXPECT_EQ(channel.encoding, "protobuf");
  }
  file->Read(
      std::vector<bool>(file->channels().size(), true),
      [&](const bag::Message& message) {
        back.messages[file->channels()[message.channel].topic].push_back(
            {message.receive_ns, std::string(bag::AsText(message.bytes))});
      },
      [](const std::string& what) { ADD_FAILURE() << what; });
  for (const bag::Channel& channel : file->channels())
    EXPECT_EQ(back.messages[channel.topic].size(), channel.messages) << channel.topic;
  return back;
}

ReadBack Exported(const Blob& blob) {
  const TestFolder folder;
  return ReadMcap(ExportMcap(blob, folder / "").value().at(0));
}

template <class T>
T At(const std::string& bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

TEST(ExportMcap, HasATopicForMapLandmarksPathsAndFrames) {
  const ReadBack back = Exported(SmallResult());
  EXPECT_TRUE(back.remarks.empty()) << "it has a summary and an index";
  EXPECT_EQ(back.types, (std::map<std::string, std::string>{{"/map", "foxglove.Grid"},
                                                            {"/map/points", "foxglove.PointCloud"},
                                                            {"/landmarks", "foxglove.SceneUpdate"},
                                                            {"/landmarks/points", "foxglove.PointCloud"},
                                                            {"/tf", "foxglove.FrameTransform"},
                                                            {"/Rosa/path", "foxglove.PosesInFrame"},
                                                            {"/Rosa/path/points", "foxglove.PointCloud"},
                                                            {"/Rosa/place", "foxglove.PointCloud"},
                                                            {"/Rosa/region", "foxglove.SceneUpdate"},
                                                            {"/a_b/path", "foxglove.PosesInFrame"},
                                                            {"/a_b/path/points", "foxglove.PointCloud"},
                                                            {"/a_b/place", "foxglove.PointCloud"},
                                                            {"/a_b/region", "foxglove.SceneUpdate"}}));
}

TEST(ExportMcap, AGridIsDrawnAsItIsAndHasItsNumbers) {
  const auto grid = Exported(SmallResult()).Get<foxglove::Grid>("/map");
  EXPECT_EQ(grid.frame_id(), "map");
  EXPECT_EQ(grid.pose().position().x(), -1);
  EXPECT_EQ(grid.pose().position().y(), -0.5);
  EXPECT_EQ(grid.cell_size().x(), 1.5);
  ASSERT_EQ(grid.column_count(), 3U);
  ASSERT_EQ(grid.data().size(), 6 * 8U);
  EXPECT_EQ(grid.row_stride(), 3 * 8U);
  ASSERT_EQ(grid.fields_size(), 5);
  EXPECT_EQ(grid.fields(4).name(), "alpha");
  EXPECT_EQ(grid.fields(4).offset(), 7U);
  // Row 0 is the lowest: nothing is known of its first cell, two others hold extracted landmarks or one
  // rather than not.
  EXPECT_TRUE(std::isnan(At<float>(grid.data(), 0)));
  EXPECT_EQ(At<std::uint8_t>(grid.data(), 7), 0) << "what is unknown is not drawn";
  EXPECT_EQ(At<float>(grid.data(), 8), 0.9F);
  EXPECT_NEAR(At<std::uint8_t>(grid.data(), 8 + 4), 255 * 0.1, 0.6);
  EXPECT_EQ(At<std::uint8_t>(grid.data(), 8 + 7), 255);
  const auto points = Exported(SmallResult()).Get<foxglove::PointCloud>("/map/points");
  ASSERT_EQ(points.data().size(), 4 * points.point_stride());  // as many as are rather occupied
  EXPECT_EQ(At<float>(points.data(), 0), 1.25F);
  EXPECT_EQ(At<float>(points.data(), 4), 0.25F);
  EXPECT_EQ(At<float>(points.data(), 12), 0.9F);
}

TEST(ExportMcap, LandmarksHaveTheirRegionsAndCovariances) {
  Blob result = SmallResult();
  // Of the second one: 1 m and 0.5 m of standard deviation along the diagonals.
  result.Put("map/landmark_covariance_m2",
             Array::Of<double>({2, 2, 2}, std::vector<double>{.04, 0, 0, .01, .625, .375, .375, .625}));
  const ReadBack back = Exported(result);
  const auto scene = back.Get<foxglove::SceneUpdate>("/landmarks");
  ASSERT_EQ(scene.entities_size(), 2);
  EXPECT_EQ(scene.entities(0).id(), "door");
  EXPECT_EQ(scene.entities(1).id(), "#1");
  EXPECT_EQ(scene.entities(1).texts(0).text(), "#1");
  const auto& region = scene.entities(1).cylinders(0);
  EXPECT_EQ(region.pose().position().x(), 1);
  EXPECT_EQ(region.pose().position().y(), 2);
  EXPECT_NEAR(2 * std::atan2(region.pose().orientation().z(), region.pose().orientation().w()), M_PI / 4,
              1e-12);
  EXPECT_NEAR(region.size().x(), 2 * 2.447746830680816, 1e-9);
  EXPECT_NEAR(region.size().y(), 2.447746830680816, 1e-9);
  EXPECT_EQ(region.top_scale(), 1);
  EXPECT_EQ(scene.entities(1).metadata(1).key(), "covariance_xy_m2");
  EXPECT_EQ(scene.entities(1).metadata(1).value(), "0.375");
  const auto points = back.Get<foxglove::PointCloud>("/landmarks/points");
  ASSERT_EQ(points.fields_size(), 6 + 4);
  ASSERT_EQ(points.point_stride(), 6 * 4 + 4U);
  ASSERT_EQ(points.data().size(), 2 * points.point_stride());
  EXPECT_EQ(At<float>(points.data(), points.point_stride() + points.fields(4).offset()), 0.375F);
  EXPECT_EQ(points.fields(6).name(), "red");
  EXPECT_EQ(At<std::uint8_t>(points.data(), points.fields(6).offset()), 217);
  EXPECT_EQ(At<std::uint8_t>(points.data(), 2 * points.point_stride() - 1), 255) << "opaque";
}

TEST(ExportMcap, APathIsThereAsPointsAndARobotAsAPointOfItsFrame) {
  const ReadBack back = Exported(SmallResult());
  const auto path = back.Get<foxglove::PosesInFrame>("/a_b/path");
  const auto points = back.Get<foxglove::PointCloud>("/a_b/path/points");
  EXPECT_EQ(points.frame_id(), "map");
  ASSERT_EQ(points.point_stride(), 12U);
  ASSERT_EQ(points.data().size(), static_cast<std::size_t>(path.poses_size()) * points.point_stride());
  for (int i = 0; i < path.poses_size(); ++i) {
    const std::size_t at = static_cast<std::size_t>(i) * points.point_stride();
    EXPECT_EQ(At<float>(points.data(), at), static_cast<float>(path.poses(i).position().x()));
    EXPECT_EQ(At<float>(points.data(), at + 4), static_cast<float>(path.poses(i).position().y()));
  }
  const auto place = back.Get<foxglove::PointCloud>("/a_b/place");
  EXPECT_EQ(place.frame_id(), "a/b") << "the frame that /tf moves";
  EXPECT_EQ(place.data().size(), place.point_stride());
}

TEST(ExportMcap, EachPoseComesAtItsTimeAndThePathAtOnce) {
  const ReadBack back = Exported(SmallResult());
  ASSERT_EQ(back.messages.at("/tf").size(), 6U);
  EXPECT_EQ(back.messages.at("/tf")[0].time_ns, 1'000'000'000);
  EXPECT_EQ(back.messages.at("/tf")[4].time_ns, 3'000'000'000);
  const auto transform = back.Get<foxglove::FrameTransform>("/tf", 2);
  EXPECT_EQ(transform.timestamp().seconds(), 2);
  EXPECT_EQ(transform.parent_frame_id(), "map");
  EXPECT_EQ(transform.child_frame_id(), "Rosa");
  EXPECT_EQ(transform.translation().x(), 1);
  EXPECT_NEAR(transform.rotation().z(), std::sqrt(0.5), 1e-12);
  const auto path = back.Get<foxglove::PosesInFrame>("/a_b/path");
  ASSERT_EQ(path.poses_size(), 3);
  EXPECT_EQ(path.poses(2).position().y(), 2);
  EXPECT_EQ(back.messages.at("/a_b/path")[0].time_ns, 1'000'000'000);
  const auto region = back.Get<foxglove::SceneUpdate>("/Rosa/region", 1);
  EXPECT_NEAR(region.entities(0).cylinders(0).size().x(), 2 * 0.2 * 2.447746830680816, 1e-9);
}

TEST(ExportMcap, AClockThatBeginsBeforeZeroIsPutForwardByWholeSeconds) {
  Blob result = SmallResult();
  for (const std::string robot : {"robot/0/", "robot/1/"})
    result.PutVector<double>(robot + "poses/time_s", {-2.25, 0.5, 1e9 + 1e-3});
  const ReadBack back = Exported(result);
  EXPECT_EQ(back.messages.at("/tf")[0].time_ns, 750'000'000);
  EXPECT_EQ(back.messages.at("/tf")[2].time_ns, 3'500'000'000);
  EXPECT_NEAR(static_cast<double>(back.messages.at("/tf")[4].time_ns - 1'000'000'003'000'000'000), 1e6, 100);
  result.PutVector<double>("robot/0/poses/time_s", {0, 1, 1e10});
  const TestFolder folder;
  ExpectContains(InputErrorOf([&] { (void)ExportMcap(result, folder / ""); }),
                 "nanoseconds are counted to 9.2e9 s");
}

TEST(ExportMcap, BeliefsAreGridsOfTheirOwnSize) {
  Blob result = SmallResult();
  result.PutVector<double>("robot/1/beliefs/time_s", {1, 2});
  result.Put("robot/1/beliefs/box",
             Array::Of<std::int32_t>({2, 4}, std::vector<std::int32_t>{0, 0, 1, 1, -1, 2, 2, 1}));
  result.PutVector<double>("robot/1/beliefs/value", {1, 0.75, 0});
  const auto grid = Exported(result).Get<foxglove::Grid>("/a_b/belief", 1);
  EXPECT_EQ(grid.pose().position().x(), -1.5 * 1.5);
  EXPECT_EQ(grid.pose().position().y(), 1.5 * 1.5);
  EXPECT_EQ(grid.column_count(), 2U);
  EXPECT_EQ(At<float>(grid.data(), 0), 0.75F);
  EXPECT_EQ(At<std::uint8_t>(grid.data(), 7), 255);
  EXPECT_EQ(At<std::uint8_t>(grid.data(), 15), 0);
  result.PutVector<double>("robot/1/beliefs/value", {1, 0.75});
  const TestFolder folder;
  ExpectContains(InputErrorOf([&] { (void)ExportMcap(result, folder / ""); }),
                 "'robot/1/beliefs/value' has not as many numbers as 'box' says");
}

TEST(ExportMcap, RobotsOfALocalMapHaveFramesOfTheirOwnBesideEachOther) {
  const ReadBack back = Exported(SmallLocalMap());
  EXPECT_FALSE(back.types.contains("/map"));
  EXPECT_FALSE(back.types.contains("/Rosa/edges"));
  const auto edges = back.Get<foxglove::PointCloud>("/a_b/edges");
  EXPECT_EQ(edges.frame_id(), "map of a/b");
  ASSERT_EQ(edges.data().size(), 2 * edges.point_stride());
  for (const auto& [at, x_m, y_m] : {std::tuple(0U, 7.5F, 21.0F), {edges.point_stride(), 14.0F, 21.5F}}) {
    EXPECT_FLOAT_EQ(At<float>(edges.data(), at), x_m);
    EXPECT_FLOAT_EQ(At<float>(edges.data(), at + 4), y_m);
  }
  std::map<std::string, double> beside_m, least_m, most_m;  // in `map`; of the poses in their frame
  for (std::size_t i = 0; i < back.messages.at("/tf").size(); ++i) {
    const auto transform = back.Get<foxglove::FrameTransform>("/tf", i);
    const double x_m = transform.translation().x();
    if (transform.parent_frame_id() == "map") {
      beside_m[transform.child_frame_id()] = x_m;
      EXPECT_EQ(transform.rotation().w(), 1);
      EXPECT_EQ(back.messages.at("/tf")[i].time_ns, 1'000'000'000);
      continue;
    }
    EXPECT_EQ(transform.parent_frame_id(), "map of " + transform.child_frame_id());
    least_m[transform.parent_frame_id()] = std::min(least_m[transform.parent_frame_id()], x_m);
    most_m[transform.parent_frame_id()] = std::max(most_m[transform.parent_frame_id()], x_m);
  }
  ASSERT_EQ(beside_m.size(), 2U);
  EXPECT_EQ(beside_m.at("map of Rosa"), 0);
  EXPECT_EQ(beside_m.at("map of a/b") + least_m.at("map of a/b"), most_m.at("map of Rosa") + 5);
  EXPECT_EQ(back.Get<foxglove::PosesInFrame>("/a_b/path").frame_id(), "map of a/b");
}

TEST(McapFile, ManyMessagesLieInSeveralChunksInOrderOfTime) {
  McapFile file;
  foxglove::FrameTransform transform;
  transform.set_child_frame_id(std::string(1000, 'x'));
  for (std::uint64_t i = 0; i < 3000; ++i) {
    transform.mutable_timestamp()->set_seconds(static_cast<std::int64_t>(2999 - i));
    file.Add("/tf", 2999 - i, transform);
  }
  const TestFolder folder;
  const std::string bytes = file.Bytes();
  std::size_t packed = 0;  // each chunk says so, and its index
  for (std::size_t at = bytes.find("zstd"); at != std::string::npos; at = bytes.find("zstd", at + 1))
    ++packed;
  EXPECT_GE(packed, 2 * 3U);
  const ReadBack back = ReadMcap(folder.Put("many.mcap", bytes));
  EXPECT_TRUE(back.remarks.empty());
  ASSERT_EQ(back.messages.at("/tf").size(), 3000U);
  for (std::size_t i = 0; i < 3000; ++i) {
    ASSERT_EQ(back.messages.at("/tf")[i].time_ns, static_cast<std::int64_t>(i));
    ASSERT_EQ(back.Get<foxglove::FrameTransform>("/tf", i).timestamp().seconds(),
              static_cast<std::int64_t>(i));
  }
}

TEST(McapFile, CutOffItsFirstChunksAreReadAllTheSame) {
  McapFile file;
  foxglove::FrameTransform transform;
  transform.set_child_frame_id(std::string(1000, 'x'));
  for (std::uint64_t i = 0; i < 3000; ++i) file.Add("/tf", i, transform);
  const TestFolder folder;
  std::string bytes = file.Bytes();
  const auto whole = bag::OpenContainer(folder.Put("cut.mcap", bytes.substr(0, bytes.size() - 100)));
  EXPECT_EQ(whole->channels().at(0).messages, 3000U);
  EXPECT_FALSE(whole->remarks().empty());
}

}  // namespace
}  // namespace cairn::datasets
