#include "datasets/import/recognize.h"

#include <filesystem>

#include "datasets/testing.h"

namespace cairn::datasets {
namespace {

std::string CommandOf(const std::string& path) {
  const auto recognized = Recognize(path);
  return recognized ? recognized->command : "";
}

TEST(Recognize, TellsFilesByTheirFirstLine) {
  const TestFolder folder;
  const auto command = [&](const char* name, const char* text) { return CommandOf(folder.Put(name, text)); };
  ExpectContains(command("a.log.gz", "# CARMEN\nPARAM robot_front_laser_max 80 0 h 0\n"),
                 "cairn import carmen /");
  ExpectContains(command("b.log", "Odometry 0 0 0\nLaser 1 2\n"), "cairn import dpslam");
  ExpectContains(command("c.log", "L -94 -139 -1 -88 -164 -1 66\n"), "cairn import wean");
  ExpectContains(command("d.txt", "1 0 0 0 0 0 0 1\n"), "cairn import tum");
  ExpectContains(command("p.txt", "# timestamp x y theta\n976052890.244 0.6 -0.03 -0.35\n"),
                 "cairn import tum");
  ExpectContains(command("costs.csv", "x_m,y_m,a,b\n0,0,0,2\n1,0,2,0\n"), "cairn import errors");
  ExpectContains(command("r.txt", "1216.6 1217.5 0.408 -0.016 0 0 0 -0.0696\n"), "--relations /");
  ExpectContains(command("e.csv", "time_s;turn_deg;forward_mm\n"), "cairn import csv --odometry");
  ExpectContains(command("E.csv", "Time_s;Turn_DEG;FORWARD_mm\n"), "cairn import csv --odometry");
  ExpectContains(command("f.csv", "time_s,landmark,range_m,bearing_rad\n"), "--observations /");
  ExpectContains(command("g.csv", "time_s,x_m,y_m,heading_rad,sonar\n"), "cairn import vectors");
  const auto scans = Recognize(folder.Put("scans.csv", "time_s,r0,r1,r2\n0,1,2,3\n"));
  ASSERT_TRUE(scans);
  EXPECT_EQ(scans->what, "a table of scans");
  ExpectContains(scans->command, "cairn import carmen SCANS.log log.h5, once its rows are lines of a CARMEN");
  ExpectContains(command("scans2.csv", "time_s;r0;r1;r2\n0;1;2;3\n"), "cairn import carmen SCANS.log");
  ExpectContains(command("excel.csv", "sep=;\r\ntime_s;turn_deg;forward_mm\r\n"), "--odometry /");
  ExpectContains(command("it's.csv", "image,time_s,x_m,y_m\n"), "it'\\''s.csv' images.h5");
  ExpectContains(command("drive.bag", "#ROSBAG V2.0\nE"), "drive.bag log.h5");
  ExpectContains(command("drive.mcap", "\x89MCAP0\r\n"), "cairn import bag /");
  ExpectContains(command("drive.db3", "SQLite format 3"), "cairn import bag /");
  EXPECT_EQ(command("h.txt", "Dear diary\n"), "");
  EXPECT_EQ(command("i.txt", ""), "");
  EXPECT_EQ(CommandOf(folder / "none"), "");
}

TEST(Recognize, TellsFoldersByTheirFiles) {
  const auto command = [](std::initializer_list<const char*> files) {
    const TestFolder folder;
    for (const char* file : files) {
      const std::string path = folder / file;
      std::filesystem::create_directories(std::filesystem::path(path).parent_path());
      folder.Put(file, "x\n");
    }
    return CommandOf(folder / "");
  };
  ExpectContains(command({"Barcodes.dat", "Robot1_Odometry.dat.gz"}), "cairn import mrclam");
  ExpectContains(command({"od.txt", "sonar.txt.gz"}), "cairn import pioneer");
  ExpectContains(command({"robot4_motors.txt"}), "cairn import lego-robot");
  ExpectContains(command({"trees/time.txt.gz"}), "cairn import victoria-park");
  ExpectContains(command({"odometry.csv.gz", "observations.csv"}), "observations.csv log.h5");
  ExpectContains(command({"a.png", "b.png"}), "cairn import images");
  const TestFolder benchmark;
  benchmark.Put("fr079.relations", "1216.6 1217.5 0.408 -0.016 0 0 0 -0.0696\n");
  benchmark.Put("freiburg.log", "FLASER 1 2\n");
  ExpectContains(CommandOf(benchmark / ""), "cairn import carmen");
  benchmark.Put("a-poses.txt", "976052890.244 0.6 -0.03 -0.35\n");
  ExpectContains(CommandOf(benchmark / ""), "freiburg.log");  // the log before what goes with it
  const TestFolder tables;                                    // by whatever name
  tables.Put("my drive.csv", "time_s;turn_deg;forward_mm\n");
  tables.Put("seen.csv", "time_s;landmark;range_m;bearing_rad\n");
  ExpectContains(CommandOf(tables / ""), "my drive.csv' --observations /");
  ExpectContains(CommandOf(tables / ""), "seen.csv log.h5");
  const TestFolder collection;
  for (const char* run : {"one", "two", "three"}) {
    std::filesystem::create_directories(collection / run);
    collection.Put(std::string(run) + "/x.log", "FLASER 1 2\n");
  }
  EXPECT_EQ(Recognize(collection / "")->what,
            "a folder of 3 folders to inspect, such as a folder with a CARMEN log, x.log, one");
  ExpectContains(command({"README", "base-01/odometry.csv", "base-02/odometry.csv"}), "base-01/odometry.csv");
  EXPECT_EQ(command({"diary.txt"}), "");
  TestFolder stopped;  // a run's folder; what a store holds is no bag
  std::filesystem::create_directories(stopped / ".cairn");
  stopped.Put(".cairn/jobs.sqlite", "SQLite format 3");
  EXPECT_EQ(CommandOf(stopped / ""), "");
  EXPECT_EQ(CommandOf(stopped / ".cairn"), "");
  EXPECT_EQ(command({}), "");
}

}  // namespace
}  // namespace cairn::datasets
