// SPDX-License-Identifier: Apache-2.0
// Walking the linear BVH with packets: rays of one direction that start near each other go through it together, as one
// ray as thick as all of them (stage/packet.cl). Other rays go as in walk/plain.cl.
#ifndef CLRAY_WALK_PACKET_CL
#define CLRAY_WALK_PACKET_CL

#include "walk/plain.cl"

#endif
