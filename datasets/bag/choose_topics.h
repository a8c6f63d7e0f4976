// Which topics an import reads, of which robot, and by whom.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/bag/container.h"
#include "datasets/bag/import_bag.h"
#include "datasets/bag/place_sensors.h"
#include "datasets/bag/readers.h"
#include "datasets/bag/topics.h"

namespace cairn::datasets::bag {

// The names of the robots: the namespaces that --robots names, or, where all topics lie in several of them,
// these. None: the bag is of one robot. Throws InputError: a namespace without topics.
std::vector<std::string> RobotsOf(const BagImportOptions& options, const std::vector<Topic>& topics);

// Those of the robot's namespace, and tf that is in no robot's. Of no `robots` all.
std::vector<Topic> TopicsOfRobot(const std::vector<Topic>& topics, const std::vector<std::string>& robots,
                                 const std::string& robot);
// The options with the robot's own topics in them: "odom" and "/odom" are its "/robot1/odom"; what is named
// of another robot is not in them.
BagImportOptions OptionsOfRobot(const BagImportOptions& options, const std::vector<std::string>& robots,
                                const Gathered& robot);

using AddReader = std::function<void(const Topic&, std::unique_ptr<TopicReader>)>;
// Hands a reader for each topic of the robot that is wanted, but for tf, to `add`: it reads `into` the
// robot. Throws InputError as ImportBag does.
void ChooseTopics(const BagImportOptions& options, const std::vector<std::unique_ptr<Container>>& bags,
                  Gathered* into, const AddReader& add);

bool HasTopic(const std::vector<Topic>& topics, const std::string& name);
// The channel's own, or what is known of its type; empty where neither is there.
std::string_view DefinitionOf(const Channel& channel);

}  // namespace cairn::datasets::bag
