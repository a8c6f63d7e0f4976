#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "datasets/images/decode_image.h"
#include "datasets/images/jpeg_form.h"
#include "datasets/import/images.h"
#include "datasets/testing.h"

namespace cairn::datasets {
namespace {

std::vector<ImageReading> ReadHere(const std::vector<std::string>& paths) {
  std::vector<ImageReading> readings;
  for (const std::string& path : paths) readings.push_back(DecodeImage(path, 1000));
  return readings;
}

class ImportImagesTest : public ImportTest {
 protected:
  ImagesImportOptions options_;
  const std::string header_ = "image,time_s,x_m,y_m\n";

  void SetUp() override {
    options_.folder = folder_ / "garden";
    std::filesystem::create_directories(options_.folder + "/deep");
    for (const char* name : {"a.png", "b.jpg", "deep/c.ppm"}) PutImage(name, 12, 16);
  }
  void PutImage(const std::string& name, int rows, int columns) {
    cv::Mat image(rows, columns, CV_8UC3);
    cv::randu(image, 0, 256);
    ASSERT_TRUE(cv::imwrite(options_.folder + "/" + name, image));
  }
  ImportReport Import(const std::string& table) {
    options_.poses = folder_.Put("poses.csv", table);
    return ImportImages(options_, ReadHere, &log_);
  }
  std::string Failure(const std::string& table) {
    log_ = Blob();
    const std::string failure = InputErrorOf([&] { Import(table); });
    EXPECT_TRUE(failure.empty() || log_.fields().empty()) << "refused, and yet something was made";
    return failure;
  }
};

TEST_F(ImportImagesTest, PutsImagesBesideTheTablesInputs) {
  Import(
      "sonar,x_m,y_m,time_s,image,heading_rad\n5,1,2,3,a.png,0.5\n6,7,8,9,./deep/"
      "c.ppm,0\n7,1,1,10,b.jpg,0\n");
  EXPECT_EQ(log_.Texts("runs"), (std::vector<std::string>{"garden"}));
  EXPECT_EQ(log_.Texts("input_name"), (std::vector<std::string>{"sonar"}));
  EXPECT_EQ(Column<double>("run/0/x_m"), (std::vector<double>{1, 7, 1}));
  EXPECT_EQ(Column<double>("run/0/heading_rad"), (std::vector<double>{0.5, 0, 0}));
  EXPECT_EQ(log_.at("run/0/input").shape(), (Shape{3, 1}));
  EXPECT_EQ(Column<float>("run/0/input"), (std::vector<float>{5, 6, 7}));
  ASSERT_EQ(log_.at("run/0/image").shape(), (Shape{3, 12, 16, 3}));
  const std::vector<std::uint8_t> images = Column<std::uint8_t>("run/0/image");
  EXPECT_EQ(std::vector<std::uint8_t>(images.begin() + 576, images.begin() + 1152),
            DecodeImage(options_.folder + "/deep/c.ppm", 1000).rgb);
}

// A decoder goes over all pixels for each scan.
TEST_F(ImportImagesTest, AJpegOfScansWithoutEndIsNotDecoded) {
  std::vector<unsigned char> jpeg;
  ASSERT_TRUE(cv::imencode(".jpg", cv::Mat(16, 16, CV_8UC3, cv::Scalar(90)), jpeg,
                           {cv::IMWRITE_JPEG_PROGRESSIVE, 1}));
  const std::string bytes(jpeg.begin(), jpeg.end() - 2), last = bytes.substr(bytes.rfind("\xFF\xDA"));
  for (const auto& [more, failure] : {std::pair(50, ""), {100, "it cannot be decoded"}}) {
    std::string all = bytes;
    for (int i = 0; i < more; ++i) all += last;
    EXPECT_EQ(DecodeImage(folder_.Put("scans.jpg", all + "\xFF\xD9"), 1000).failure, failure) << more;
  }
}

// A decoder makes a whole picture of what there is of one, and fills up the rest.
TEST_F(ImportImagesTest, AnImageThatBreaksOffIsRefused) {
  cv::Mat image(64, 48, CV_8UC3);
  cv::randu(image, 0, 256);
  for (const char* ending : {".jpg", ".png", ".ppm", ".bmp"}) {
    std::vector<unsigned char> whole;
    ASSERT_TRUE(cv::imencode(ending, image, whole));
    const std::string bytes(whole.begin(), whole.end());
    const auto failure_of = [&](const std::string& given) {
      return DecodeImage(folder_.Put(std::string("cut") + ending, given), 1000).failure;
    };
    EXPECT_EQ(failure_of(bytes), "") << ending;
    for (const std::size_t eighths : {1, 4, 7})
      EXPECT_TRUE(failure_of(bytes.substr(0, bytes.size() * eighths / 8)).starts_with("it cannot be decoded"))
          << ending << ' ' << eighths;
  }
}

// By its markers: an end within a segment, as a thumbnail's, is not the picture's.
TEST(BreaksOff, IsToldByTheEndMarker) {
  using namespace std::string_literals;
  const std::string start = "\xFF\xD8", thumbnail = "\xFF\xE1\x00\x06\xFF\xD8\xFF\xD9"s,
                    scan = "\xFF\xDA\x00\x02 a\xFF\x00 b\xFF\xD0 c"s, end = "\xFF\xD9";
  EXPECT_FALSE(BreaksOff(start + thumbnail + scan + end));
  EXPECT_FALSE(BreaksOff(start + scan + "\xFF\xFF" + end + "what a camera adds")) << "filled up";
  for (const std::string& cut :
       {start + thumbnail + scan, start + thumbnail, start + "\xFF\xE1", start + "\xFF\xE1\x7F\xFF and",
        start + scan + "\xFF", start + scan + std::string(100, '\0')})
    EXPECT_TRUE(BreaksOff(cut)) << cut.size();
  EXPECT_FALSE(BreaksOff("\x89PNG")) << "no JPEG";
}

// A table may name one image as often as it likes, and a folder may have as many as it likes.
TEST_F(ImportImagesTest, TheirPixelsAreBounded) {
  const std::string one = "a.png,0,0,0\na.png,1,0,0\na.png,2,0,0\n", pixels = header_ + one;
  options_.skip_bad = true;  // the other images have no pose
  options_.most_image_bytes = 3 * 12 * 16 * 3;
  EXPECT_EQ(Failure(pixels), "");
  options_.most_image_bytes -= 1;
  EXPECT_NE(Failure(pixels).find("its images take more than 1.7 kB"), std::string::npos) << Failure(pixels);
  std::string table = header_;
  for (int i = 0; i < 100; ++i) {
    const std::string name = "many" + std::to_string(i) + ".ppm";
    PutImage(name, 12, 16);
    table += name + "," + std::to_string(i) + ",0,0\n";
  }
  std::size_t read = 0;
  options_.poses = folder_.Put("poses.csv", table);
  EXPECT_THROW(ImportImages(
                   options_,
                   [&read](const std::vector<std::string>& paths) {
                     read += paths.size();
                     return ReadHere(paths);
                   },
                   &log_),
               InputError);
  EXPECT_LT(read, 100u);
}

// A reader that says of few images at a time, for they are large, is asked for the others; and for no more
// than it takes to see that they are too many.
TEST_F(ImportImagesTest, OfLargeImagesFewAreInMemoryBeforeTheyAreCounted) {
  std::size_t read = 0;
  const ImageReader two = [&read](const std::vector<std::string>& paths) {
    const std::vector<ImageReading> readings = DecodeImages(paths, 1000, 12 * 16 * 3 + 1);
    read += readings.size();
    EXPECT_LE(readings.size(), 2u);
    return readings;
  };
  options_.poses = folder_.Put("poses.csv", header_ + "a.png,0,0,0\nb.jpg,1,0,0\ndeep/c.ppm,2,0,0\n");
  ImportImages(options_, two, &log_);
  EXPECT_EQ(read, 3u);
  EXPECT_EQ(log_.at("run/0/image").shape(), (Shape{3, 12, 16, 3}));
  options_.most_image_bytes = 12 * 16 * 3;
  read = 0;
  EXPECT_THROW(ImportImages(options_, two, &log_), InputError);
  EXPECT_EQ(read, 2u);
}

// The track is straight, 1 m/s, and turns; the ranges come twice a second.
TEST_F(ImportImagesTest, TakesPosesOfATrackAndRangesByTime) {
  options_.times = folder_.Put("times.csv", "time_s,image\n0.25,a.png\n1,b.jpg\n1.75,deep/c.ppm\n");
  options_.ranges = folder_.Put("ranges.csv", "front,time_s\n10,0\n20,0.5\n30,1\n40,1.5\n50,2\n");
  Import("time_s,x_m,y_m,heading_rad\n0,0,5,3\n1,1,5,-3\n2,2,5,-2\n");
  EXPECT_EQ(Column<double>("run/0/x_m"), (std::vector<double>{0.25, 1, 1.75}));
  EXPECT_EQ(Column<double>("run/0/y_m"), (std::vector<double>{5, 5, 5}));
  EXPECT_NEAR(Column<double>("run/0/heading_rad")[0], 3.07, 0.01);
  EXPECT_EQ(log_.Texts("input_name"), (std::vector<std::string>{"front"}));
  EXPECT_EQ(Column<float>("run/0/input"), (std::vector<float>{10, 30, 40}));
}

TEST_F(ImportImagesTest, SaysWhatNoTrackOrRangeIsNear) {
  const std::string track = "time_s,x_m,y_m\n0,0,5\n1,1,5\n9,2,5\n";
  const auto times = [&](const std::string& rows) {
    options_.times = folder_.Put("times.csv", "image,time_s\n" + rows);
  };
  times("a.png,0\nb.jpg,1\ndeep/c.ppm,2\n");
  ExpectContains(Failure(track), "times.csv:4: no pose at its time: the track says nothing of 2.0");
  times("a.png,0\nb.jpg,1\ndeep/c.ppm,10\n");
  ExpectContains(Failure(track), "times.csv:4: no pose at its time");
  times("a.png,0\nb.jpg,1\ndeep/c.ppm,1\n");
  EXPECT_EQ(Failure(track), "");
  options_.ranges = folder_.Put("ranges.csv", "time_s,front\n3,1\n");
  ExpectContains(Failure(track), "times.csv:2: no ranges at its time");
  folder_.Put("ranges.csv", "time_s\n3\n");
  ExpectContains(Failure(track), "ranges.csv:1: the header has no inputs");
  folder_.Put("ranges.csv", "time_s,front\n0,west\n");
  ExpectContains(Failure(track), "ranges.csv:2: not a number");
}

TEST_F(ImportImagesTest, RunsAreByTheirColumn) {
  Import(
      "image,time_s,x_m,y_m,run\na.png,5,0,0,out\nb.jpg,1,0,0,home\ndeep/"
      "c.ppm,6,1,0,out\na.png,2,3,0,home\n");
  EXPECT_EQ(log_.Texts("runs"), (std::vector<std::string>{"out", "home"}));
  EXPECT_EQ(Column<double>("run/0/time_s"), (std::vector<double>{5, 6}));
  EXPECT_EQ(Column<double>("run/1/time_s"), (std::vector<double>{1, 2}));
  EXPECT_TRUE(log_.Texts("input_name").empty());
  EXPECT_EQ(log_.at("run/0/input").shape(), (Shape{2, 0}));
  EXPECT_EQ(log_.at("run/1/image").shape(), (Shape{2, 12, 16, 3}));
}

TEST_F(ImportImagesTest, BadTablesNameFileLineAndReason) {
  const std::string all = "a.png,1,0,0\nb.jpg,2,1,0\ndeep/c.ppm,3,2,0\n";
  EXPECT_EQ(Failure(header_ + all), "");
  ExpectContains(Failure(header_ + all + "d.png,4,0,0\n"), "poses.csv:5: no such image: ");
  ExpectContains(Failure(header_ + all + "a.png,1,0,0\n"), "poses.csv:5: time runs backwards");
  ExpectContains(Failure(header_ + all + "a.png,5,east,0\n"), "poses.csv:5: not a number");
  ExpectContains(Failure("image,time_s,x_m,y_m,run\na.png,1,0,0,\n"), "poses.csv:2: run without a name");
  ExpectContains(Failure("image,time_s,x_m,y_m,run\na.png,1,0,0,a\x01\n"),
                 "poses.csv:2: a name that has control characters: run is 'a '");
  ExpectContains(Failure("image,time_s,x_m\n"), "poses.csv:1: the header lacks columns");
  ExpectContains(Failure(header_ + "a.png,1,0,0\nb.jpg,2,0,0\n"), "deep/c.ppm: image without a pose: ");
  ExpectContains(Failure("image,time_s,x_m,y_m,run\n"
                         "a.png,1,0,0,r\nb.jpg,2,0,0,r\ndeep/c.ppm,2,0,0,s\n"),
                 "poses.csv: a run has two samples or more; 's' has one");
  options_.folder = folder_ / "nowhere";
  ExpectContains(Failure(header_ + all), "nowhere: there is no such folder");
}

// A data set is somebody else's: what it names may be any file of the reader's.
TEST_F(ImportImagesTest, ImagesOutsideOfTheFolderAreRefused) {
  PutImage("../private.png", 12, 16);
  const std::string outside = std::filesystem::canonical(folder_ / "private.png").string();
  std::filesystem::create_symlink(outside, options_.folder + "/link.png");
  std::filesystem::create_symlink("a.png", options_.folder + "/inside.png");
  for (const std::string& image : {std::string("../private.png"), std::string("deep/../../private.png"),
                                   outside, std::string("link.png")})
    EXPECT_NE(Failure(header_ + image + ",0,0,0\n").find("image outside of the folder"), std::string::npos)
        << image;
  options_.skip_bad = true;
  EXPECT_EQ(Failure(header_ + "inside.png,0,0,0\na.png,1,1,0\n"), "");
}

TEST_F(ImportImagesTest, BadImagesNameTheLine) {
  folder_.Put("garden/text.png", "no image");
  PutImage("small.png", 12, 15);
  const std::string all = "a.png,1,0,0\nb.jpg,2,1,0\ndeep/c.ppm,3,2,0\n";
  ExpectContains(Failure(header_ + all + "text.png,4,3,0\nsmall.png,5,4,0\n"),
                 "poses.csv:5: bad image: " + options_.folder + "/text.png: it cannot be decoded");
  ExpectContains(Failure(header_ + all + "small.png,4,3,0\ntext.png,5,4,0\n"),
                 "poses.csv:5: image of another size: " + options_.folder +
                     "/small.png: 12 by 15, the run's first 12 by 16");
  options_.skip_bad = true;
  const ImportReport report =
      Import(header_ + "a.png,1,0,0\nb.jpg,2,1,0\nsmall.png,4,3,0\ntext.png,5,4,0\nx.png,6,0,0\n");
  EXPECT_EQ(report.skipped, (std::map<std::string, std::int64_t>{{"bad image", 1},
                                                                 {"image of another size", 1},
                                                                 {"image without a pose", 1},
                                                                 {"no such image", 1}}));
  EXPECT_EQ(Column<double>("run/0/time_s"), (std::vector<double>{1, 2}));
}

TEST(DecodeImage, KeepsColoursInOrder) {
  const TestFolder folder;
  const cv::Mat image(10, 11, CV_8UC3, cv::Scalar(30, 20, 10));  // blue, green, red
  ASSERT_TRUE(cv::imwrite(folder / "a.png", image));
  const ImageReading rgb = DecodeImage(folder / "a.png", 11);
  EXPECT_EQ(rgb.rows, 10);
  EXPECT_EQ(rgb.columns, 11);
  ASSERT_EQ(rgb.rgb.size(), 330U);
  EXPECT_EQ((std::vector<std::uint8_t>{rgb.rgb[327], rgb.rgb[328], rgb.rgb[329]}),
            (std::vector<std::uint8_t>{10, 20, 30}));
}

TEST(DecodeImage, OfALargeSquareTheMeanIsRight) {
  const TestFolder folder;
  ASSERT_TRUE(cv::imwrite(folder / "a.png", cv::Mat(2100, 2100, CV_8UC3, cv::Scalar(30, 20, 250))));
  EXPECT_EQ(DecodeImage(folder / "a.png", 1).rgb, (std::vector<std::uint8_t>{250, 20, 30}));
}

// 7 by 11 pixels in squares of 3: 2 by 3, of which each is the mean of nine.
TEST(DecodeImage, MakesLargeImagesSmaller) {
  const TestFolder folder;
  cv::Mat image(7, 11, CV_8UC3, cv::Scalar(0, 0, 0));
  image.at<cv::Vec3b>(4, 8) = {0, 9, 200};
  ASSERT_TRUE(cv::imwrite(folder / "a.png", image));
  const ImageReading rgb = DecodeImage(folder / "a.png", 4);
  EXPECT_EQ(rgb.rows, 2);
  EXPECT_EQ(rgb.columns, 3);
  std::vector<std::uint8_t> expected(18);
  expected[15] = 22;  // 200 / 9
  expected[16] = 1;
  EXPECT_EQ(rgb.rgb, expected);
}

TEST(DecodeImages, EndsWhereTheirPixelsTakeWhatTheyMay) {
  const TestFolder folder;
  std::vector<std::string> paths;
  for (const char* name : {"a.png", "b.png", "c.png"}) {
    paths.push_back(folder / name);
    ASSERT_TRUE(cv::imwrite(paths.back(), cv::Mat(2, 5, CV_8UC3, cv::Scalar(0, 0, 0))));
  }
  paths.insert(paths.begin(), folder / "missing.png");
  EXPECT_EQ(DecodeImages(paths, 10, 0).size(), 1u);
  EXPECT_EQ(DecodeImages(paths, 10, 30).size(), 2u);
  EXPECT_EQ(DecodeImages(paths, 10, 31).size(), 3u);
  EXPECT_EQ(DecodeImages(paths, 10, 1000).size(), 4u);
}

}  // namespace
}  // namespace cairn::datasets
