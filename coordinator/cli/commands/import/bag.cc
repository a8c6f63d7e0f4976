#include "coordinator/cli/commands/import/parts.h"
#include "coordinator/cli/common/failure.h"
#include "coordinator/cli/common/programs.h"
#include "coordinator/cli/output/path.h"
#include "datasets/bag/in_child.h"
#include "schema/store/atomic_file.h"

namespace cairn::cli {
namespace {

struct BagOptions : ImportOutput {
  datasets::BagImportOptions import;
  std::vector<std::string> mounts;
};

int ImportBag(const BagOptions& options, const Invocation&) {
  CheckOutputIsNoInput(options.out, options.import.files);
  for (const std::string& file : options.import.files) CheckOutputIsNotInDataset(options.out, file);
  CheckOverwrite(options.out, options.force);
  datasets::BagImportOptions import = options.import;
  if (!import.tags.empty())
    import.find_tags = [program = TagsProgram()](const std::string& family, const std::string& images) {
      try {
        return OutputOf(program, {family}, images);
      } catch (const WorldError& error) {
        throw InputError(error.what());  // as the child hands it over
      }
    };
  for (const std::string& mount : options.mounts)
    AddOnce("--mount", ParseNamedMount(mount, "/scan=0.1,0,180"), &import.mounts);
  import.folder = std::filesystem::absolute(options.out).parent_path();
  const Result<datasets::StoredImport> stored = datasets::ImportBagInChild(
      import, [&](const Blob& log, const datasets::ImportReport& report) -> Result<std::string> {
        try {
          return WriteImport(options, log, report);
        } catch (const WorldError& error) {
          return Status(Code::kIo, error.what());
        }
      });
  if (!stored.ok()) RemoveLeftoversOf(options.out);  // of a child that broke off
  const datasets::StoredImport made = Take(stored);
  return TellImport(options, made.told, made.report);
}

void AddTopics(Command command, datasets::BagImportOptions& bag) {
  command.Add("--robots", bag.robots,
              "NAMESPACE,NAMESPACE of several robots (else found where all topics lie in several); 'none'");
  command.Add("--odometry", bag.odometry,
              "Topic of nav_msgs/Odometry, or of velocities (Twist); 'tf': the frame that moves on 'odom'");
  command.Add("--wheels", bag.wheels,
              "Odometry by joints: LEFT_JOINT,RIGHT_JOINT,RADIUS_M,DISTANCE_M of a differential drive");
  command.Add("--gyro", bag.gyro,
              "Topic of sensor_msgs/Imu: the odometry turns as it does, its bias taken out ('/imu*deg')");
  command.Add("--scan", bag.scans, "Topic of laser scans (again: of several lasers); 'none'").OneEachTime();
  command.Add(
      "--cloud", bag.cloud,
      "LOW_M,HIGH_M,REACH_M: of a --scan that is clouds of points (PointCloud2), those at these heights");
  command.Add("--sonar", bag.sonars, "Topic of sensor_msgs/Range (again: of several; else all); 'none'")
      .OneEachTime();
  command
      .Add("--landmarks", bag.landmarks,
           "Topic of detected markers, as landmarks; TOPIC:range=FIELD,bearing=FIELD,id=FIELD or x=, y=: "
           "fields of any messages; tf:BEGINNING: frames of such names (again: of several)")
      .OneEachTime();
  command
      .Add("--tags", bag.tags,
           "TOPIC=METRES: images in which AprilTags with black squares of that edge are landmarks (again: "
           "of several)")
      .OneEachTime();
  command.Add("--tag-family", bag.tag_family, "Of which they are").ShowDefault();
  command.Add("--camera", bag.camera,
              "FX,FY,CX,CY[,K1,K2,P1,P2,K3] of the images (else as the camera_info beside them says)");
  command.Add("--truth", bag.truth,
              "Topic of poses that are the truth: Odometry, PoseStamped, Path, NavSatFix, …; 'tf': on 'map'");
  command.Add("--poses", bag.poses, "Topic of poses that a program corrected (amcl's, say); 'tf': on 'map'");
}

}  // namespace

void AddBagImport(Command import, Invocation& call) {
  Command command;
  const auto options = AddCommand<BagOptions>(
      import, call, "bag", "Bags of ROS 1 and 2, without ROS: .bag, .db3, .mcap (docs/bags.md)",
      "cairn import bag drive.bag log.h5", ImportBag, &command);
  datasets::BagImportOptions& bag = options->import;
  command.PlaceByChecks();  // by their endings: any number of bags, then the file to write
  command.Add("FILE", bag.files, "A bag, or a folder of rosbag2; of a drive in several all of them")
      .Required()
      .Check([](const std::string& name) { return name.ends_with(".h5") ? "a bag is no .h5 file" : ""; });
  AddTopics(command, bag);
  command.Add("--base", bag.base, "The robot's frame in tf (else that of the odometry)");
  command
      .Add("--mount", options->mounts,
           "Where a sensor sits, TOPIC=X,Y,DEGREES or FRAME=X,Y,DEGREES on the robot (else as tf says; "
           "again: of several)")
      .OneEachTime();
  command.Add("--from", bag.from_s, "Leave out what was before so many seconds").NotNegative();
  command.Add("--until", bag.until_s, "Leave out what was after so many seconds").NotNegative();
  command.AddFlag("--by-receipt", bag.by_receipt,
                  "Times are those at which the recorder had a message, not those of its header");
  command
      .Add("--max-memory-mb", bag.memory_mb,
           "What reading may take of memory (else 2048, and 8 times the files)")
      .Within(std::uint64_t{1}, std::uint64_t{1} << 30);
  AddOdometryNoise(command, bag.noise);
  AddSensorNoise(command, bag.noise);
  command.AddFlag("--skip-bad", bag.skip_bad, "Skip bad messages and count them, by reason");
  command.AddFlag(kUnitsAreRight, options->units_are_right,
                  "Take in what no robot does (60 m/s, two turns a second), instead of asking for units");
  command.AddFlag("--force", options->force, "Replace OUT.h5 where it is there already");
  command.AddFlag("--json", options->json, "Say what was read, skipped and left out as JSON");
  command.Add("OUT.h5", options->out, "The file to write").Required();
}

}  // namespace cairn::cli
