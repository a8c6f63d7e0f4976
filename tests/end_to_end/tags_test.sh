#!/usr/bin/env bash
# AprilTags in a bag's images, drawn by no code of Cairn's and with libapriltag's own pictures of the tags: found, mapped, and where they
# truly are.
source "$(dirname "$0")/common.sh"

pictures=$CAIRN_BUILD/tests/end_to_end/tag_pictures
[ -x "$pictures" ] || skip "built without Debian's libapriltag-dev"
/usr/bin/python3 -c 'import rosbag, sensor_msgs.msg, nav_msgs.msg, numpy, PIL, h5py' 2>/dev/null ||
  skip "Debian's python3-rosbag, python3-nav-msgs, python3-sensor-msgs, python3-pil and python3-h5py are not installed"
mkdir tags
"$pictures" tag36h11 10 tags
/usr/bin/python3 "$CAIRN_SOURCE/tests/end_to_end/make_tag_bag.py" tags drive.bag
exits 0 cairn inspect drive.bag
says 'camera/image_raw sensor_msgs/Image: .* as images in which AprilTags are landmarks, with --tags$'
take=(--truth /truth --mount /camera/image_raw=0.15,0.05,-60)
exits 0 cairn import bag drive.bag log.h5 --tags /camera/image_raw=0.2 "${take[@]}"
says '^cairn: read [0-9]{2,}: tags in [0-9]+ images of /camera/image_raw$'

# The camera as somebody says it, instead of the message beside it: the same.
camera=420,425,315,243,-0.12,0.03,0.001,-0.0007
exits 0 cairn import bag drive.bag said.h5 --tags /camera/image_raw=0.2 --camera $camera "${take[@]}"
same_bits log.h5 said.h5
exits 0 cairn import bag drive.bag compressed.h5 --tags /camera/image_raw/compressed=0.2 --truth /truth --mount camera=0.15,0.05,-60
says '^cairn: read [0-9]+: tags in [0-9]+ images of /camera/image_raw/compressed$'
refuses "no family of tags that is known: 'tag7'" cairn import bag drive.bag x.h5 --tags /camera/image_raw=0.2 --tag-family tag7 "${take[@]}"
refuses 'what is meant is TOPIC=METRES' cairn import bag drive.bag x.h5 --tags /camera/image_raw "${take[@]}"
refuses 'what is meant is FX,FY,CX,CY' cairn import bag drive.bag x.h5 --tags /camera/image_raw=0.2 --camera 400 "${take[@]}"
refuses 'that topic is of nav_msgs/Odometry' cairn import bag drive.bag x.h5 --tags /odom=0.2 "${take[@]}"
refuses "no tf says where that is" cairn import bag drive.bag x.h5 --tags /camera/image_raw=0.2

# An image of more pixels than a camera has is not unpacked; one that follows it is looked at.
/usr/bin/python3 - "$(ls tags/*.png | head -n 1)" >images <<'END'
import struct, sys, zlib
side = 12000
chunk = lambda kind, data: struct.pack('>I', len(data)) + kind + data + struct.pack('>I', zlib.crc32(kind + data))
bomb = (b'\x89PNG\r\n\x1a\n' + chunk(b'IHDR', struct.pack('>IIBBBBB', side, side, 8, 0, 0, 0, 0)) +
        chunk(b'IDAT', zlib.compress(bytes((side + 1) * side), 1)) + chunk(b'IEND', b''))
for image in (bomb, open(sys.argv[1], 'rb').read()):
    sys.stdout.buffer.write(b'%d\n' % len(image) + image)
END
cairn-tags tag36h11 <images >found || die "cairn-tags failed"
[ "$(head -n 1 found)" = '!it cannot be decoded' ] && [ "$(wc -l <found)" -eq 2 ] || die "cairn-tags said: $(cat found)"

exits 0 cairn map log.h5 --out map
cp log.h5 truth.h5
/usr/bin/python3 "$CAIRN_SOURCE/tests/end_to_end/make_tag_bag.py" --truth truth.h5
exits 0 cairn evaluate map --truth truth.h5
says '^landmarks.found +10 of 10'
says '^landmarks.spurious +0$'
says '^landmarks.rmse_m +0\.0[0-4]'
says '^trajectory.rmse_m +0\.0[0-9]'
