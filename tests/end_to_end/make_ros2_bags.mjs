// ODOM and FLASER lines of a CARMEN log, headings 0, as bags of ROS 2 that programs which are not ours write: MCAP by @mcap/core, messages by
// @foxglove/rosmsg2-serialization, and what SQLite's shell makes a .db3 of.
//
//     npm install --prefix . @mcap/core@2.2.2 @foxglove/rosmsg2-serialization@3.1.0 @foxglove/rosmsg@5
//     NODE_PATH=node_modules node make_ros2_bags.mjs LOG CHUNKED.mcap PLAIN.mcap OUT.sql
//
// ros2_bags.tar.gz holds what it made of the log in bag_test.sh (node 20.20).
import fs from 'node:fs';
import { createRequire } from 'node:module';
import path from 'node:path';

const require = createRequire(path.join(path.resolve(process.env.NODE_PATH), 'x.js'));
const { McapWriter } = require('@mcap/core');
const { MessageWriter } = require('@foxglove/rosmsg2-serialization');
const { parse } = require('@foxglove/rosmsg');

const part = (name, text) => `${'='.repeat(80)}\nMSG: ${name}\n${text}`;
const HEADER = part('std_msgs/Header', 'builtin_interfaces/Time stamp\nstring frame_id\n') +
    part('builtin_interfaces/Time', 'int32 sec\nuint32 nanosec\n');
const VECTOR = part('geometry_msgs/Vector3', 'float64 x\nfloat64 y\nfloat64 z\n');
const TYPES = {
  'nav_msgs/msg/Odometry': `std_msgs/Header header
string child_frame_id
geometry_msgs/PoseWithCovariance pose
geometry_msgs/TwistWithCovariance twist
${HEADER}${part('geometry_msgs/PoseWithCovariance', 'geometry_msgs/Pose pose\nfloat64[36] covariance\n')}${
    part('geometry_msgs/Pose', 'geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n')}${
    part('geometry_msgs/Point', 'float64 x\nfloat64 y\nfloat64 z\n')}${
    part('geometry_msgs/Quaternion', 'float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n')}${
    part('geometry_msgs/TwistWithCovariance', 'geometry_msgs/Twist twist\nfloat64[36] covariance\n')}${
    part('geometry_msgs/Twist', 'geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n')}${VECTOR}`,
  'sensor_msgs/msg/LaserScan': `std_msgs/Header header
float32 angle_min
float32 angle_max
float32 angle_increment
float32 time_increment
float32 scan_time
float32 range_min
float32 range_max
float32[] ranges
float32[] intensities
${HEADER}`,
};
const TOPICS = { '/odom': 'nav_msgs/msg/Odometry', '/scan': 'sensor_msgs/msg/LaserScan' };
const writers = {};
for (const [type, text] of Object.entries(TYPES))
  writers[type] = new MessageWriter(parse(text, { ros2: true }));

function* messages(log) {
  for (const line of fs.readFileSync(log, 'utf8').split('\n')) {
    const words = line.split(/\s+/);
    if (words[0] !== 'ODOM' && words[0] !== 'FLASER') continue;
    const [sec, fraction = ''] = words.at(-3).split('.');
    const stamp = { sec: Number(sec), nanosec: Number(`${fraction}000000000`.slice(0, 9)) };
    const beams = words[0] === 'FLASER' ? Number(words[1]) : 0;
    const [x, y, heading] = words.slice(beams ? 2 + beams + 3 : 1).map(Number);
    if (heading !== 0) throw new Error(`${line}: headings must be 0`);
    const none = { x: 0, y: 0, z: 0 }, covariance = Array(36).fill(0);
    const write = (topic, message) =>
      ({ topic, stamp: BigInt(sec) * 1000000000n + BigInt(stamp.nanosec), data: writers[TOPICS[topic]].writeMessage(message) });
    yield write('/odom', {
      header: { stamp, frame_id: 'odom' }, child_frame_id: 'base_link',
      pose: { pose: { position: { x, y, z: 0 }, orientation: { x: 0, y: 0, z: 0, w: 1 } }, covariance },
      twist: { twist: { linear: none, angular: none }, covariance },
    });
    if (!beams) continue;
    const step = Math.PI / 180 * (beams % 2 === 0 ? 180 / beams : 180 / (beams - 1)), angle_min = Math.fround(-Math.PI / 2);
    yield write('/scan', {
      header: { stamp, frame_id: 'base_link' }, angle_min, angle_max: angle_min + (beams - 1) * step, angle_increment: step,
      time_increment: 0, scan_time: 0, range_min: 0, range_max: 50, ranges: words.slice(2, 2 + beams).map(Number), intensities: [],
    });
  }
}

async function mcap(log, out, useChunks) {
  let bytes = [], size = 0n;
  const writable = { position: () => size, write: async (more) => { bytes.push(Buffer.from(more)); size += BigInt(more.length); } };
  const writer = new McapWriter({ writable, useChunks, chunkSize: 4096 });
  await writer.start({ profile: 'ros2', library: 'make_ros2_bags.mjs' });
  const channels = {};
  for (const [topic, name] of Object.entries(TOPICS)) {
    const schemaId = await writer.registerSchema({ name, encoding: 'ros2msg', data: Buffer.from(TYPES[name]) });
    channels[topic] = await writer.registerChannel({ schemaId, topic, messageEncoding: 'cdr', metadata: new Map() });
  }
  let sequence = 0;
  for (const { topic, stamp, data } of messages(log))
    await writer.addMessage({ channelId: channels[topic], sequence: sequence++, logTime: stamp, publishTime: stamp, data });
  await writer.end();
  fs.writeFileSync(out, Buffer.concat(bytes));
}

function sql(log) {
  const ids = Object.keys(TOPICS);
  let text = `CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);
CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL, data BLOB NOT NULL);
BEGIN;
`;
  ids.forEach((topic, i) => { text += `INSERT INTO topics VALUES(${i + 1}, '${topic}', '${TOPICS[topic]}', 'cdr', '');\n`; });
  for (const { topic, stamp, data } of messages(log))
    text += `INSERT INTO messages(topic_id, timestamp, data) VALUES(${ids.indexOf(topic) + 1}, ${stamp}, X'${Buffer.from(data).toString('hex')}');\n`;
  return `${text}COMMIT;\n`;
}

const [log, chunked, plain, statements] = process.argv.slice(2);
await mcap(log, chunked, true);
await mcap(log, plain, false);
fs.writeFileSync(statements, sql(log));
