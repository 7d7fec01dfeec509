// SPDX-License-Identifier: Apache-2.0
// Every struct that crosses between host and device. Only 32- and 64-bit scalars and arrays of them; padding is
// explicit; sizes are asserted on both sides. Lengths in m, directions are unit vectors away from the body,
// body frame throughout.
#ifndef CLRAY_ABI_H
#define CLRAY_ABI_H

#include "shared/bvh_node.h"
#include "shared/portable.h"

#define CLRAY_MATERIAL_PARAMETERS 12

#define CLRAY_MATERIAL_TWO_SIDED 1u
#define CLRAY_PRIMITIVE_PLANE 1u  // no ray leaving it can hit it again

/// One material under one lane (variant and band). p: the row's keys in order, then derived numbers.
typedef struct ClrayMaterial {
  u32 model;        // row number in brdf.def
  u32 flags;        // CLRAY_MATERIAL_*
  u32 table;        // offset of the model's own table in `tables`
  u32 reflectance;  // offset of the directional-reflectance table in `tables`: count, its mu (ascending), its values
  f64 emissivity;   // infrared
  f64 p[CLRAY_MATERIAL_PARAMETERS];
} ClrayMaterial;

/// One primitive, in the order of the BVH's leaves.
typedef struct ClrayPrimitive {
  u32 shape;      // row number in shape.def
  u32 data;       // offset of its numbers in `shapes`
  u32 material;   // column of the material table
  u32 id;         // canonical rank: ties go to the smaller
  u32 component;  // index into Scene::components
  u32 flags;      // CLRAY_PRIMITIVE_*
  u32 planes;  // offset in `shapes` of the planes of its flat parts; CLRAY_NO_PLANES: it shares none with another face
  u32 padding;
} ClrayPrimitive;
#define CLRAY_NO_PLANES 0xffffffffu

// Faces that overlap in one plane have one set of coefficients of it, so that a ray meets all of them at one t,
// exactly. A part's record in `shapes`: unit normal (3), offset (normal·x on the plane), number of the plane (0: this
// part shares none), and whether the face looks along the normal (1) or against it (-1).
#define CLRAY_PLANE_OFFSET 3
#define CLRAY_PLANE_NUMBER 4
#define CLRAY_PLANE_FACING 5
#define CLRAY_PLANE_SIZE 6

// An analytic shape's numbers in `shapes`: rotation body -> local (9, by rows), origin (3), scale, then its keys.
#define CLRAY_SHAPE_ORIGIN 9
#define CLRAY_SHAPE_SCALE 12
#define CLRAY_SHAPE_KEYS 13

/// A part that turns about a hinge, in one view: rigid motion body -> part.
typedef struct ClrayInstance {
  f64 rotation[9];     // by rows
  f64 translation[3];  // x_part = rotation·x_body + translation
  f64 box_centre[3];
  f64 box_scale;
  u32 root;
  u32 moved;  // 0: the part stands in the body frame, nothing to carry
} ClrayInstance;

/// One view of a pass: where its rays start, and the scales of its sums. Nothing here depends on the other views, so
/// that a view has the same sums alone and among others.
typedef struct ClrayView {
  f64 toward[3];  // unit vector from the body to where rays start: s for a beam, o for pixels
  f64 corner[3];  // rays start at corner + u·edge_u + v·edge_v, u and v in (0,1)
  f64 edge_u[3], edge_v[3];
  f64 box_centre[3];  // box frame of the tree at `root`
  f64 box_scale;
  u32 root;                   // of the top-level BVH (or of the only one)
  u32 first_stratum, strips;  // strata of the beam; 0: its rectangle is sampled evenly
  u32 grid;                   // cells along each edge of the rectangle
  // Share of a ray = share_scale·CLRAY_PIECE_PARTS·(area of piece / area of cell)/(width of strip·width of piece).
  f64 share_scale;
  // Moments of delay are of tau = (path - path_middle_m)·inv_path_per_m, in [-1,1] for one bounce.
  f64 path_middle_m, inv_path_per_m;
  f64 weight_scale;  // 2^S for weights toward a connection
  f64 weight_limit;  // larger weights go to the second accumulator
  u32 key0, key1;    // of the view's own scrambles, see host/beam/beams.hpp
} ClrayView;

/// A stratum of the beam: a strip of a view, or a piece of a strip (host/beam/strata.hpp). A uniform 32-bit
/// number chooses the stratum whose `last` is the first that is not below it.
typedef struct ClrayStratum {
  u32 last;
  u32 guide;  // in the k-th of n strata: where a search for numbers from k/n of 2^32 on may begin
  u32 a, b;   // of a strip: its first piece, the number of its pieces; of a piece: see below
} ClrayStratum;
// A piece is a part of a cell between two lines of equal path length. Its `a` holds the cell (row·grid + column) and
// the direction of the lines: the smaller slope of path over the larger, which of u and v has the larger, and which
// fall. Its `b` holds the area of the cell below each line, in 1/CLRAY_PIECE_PARTS: bits 0-15, and bits 16-31 plus one.
#define CLRAY_PIECE_CELL 0x3ffffu
#define CLRAY_PIECE_STEEPNESS_SHIFT 18
#define CLRAY_PIECE_PARTS 65536
#define CLRAY_PIECE_STEEPNESS 512  // of 1, in 10 bits
#define CLRAY_PIECE_REVERSE (1u << 28)
#define CLRAY_PIECE_FLIP_U (1u << 29)
#define CLRAY_PIECE_FLIP_V (1u << 30)
#define CLRAY_PIECE_SWAP (1u << 31)

/// One direction to which hits are connected in one view: an observer for a beam, the source for pixels.
typedef struct ClrayConnection {
  f64 direction[3];
  f64 acceptance_chord2;  // squared chord of the acceptance half angle; 0: no cone
  f64 inv_solid_angle;    // 1/sr of the cone
  u32 shadow;             // 0: what starts the ray is also where it connects (monostatic)
  u32 padding;
} ClrayConnection;

/// A block of sums: the numbers of a row stand together, rows one after the other. A row belongs to a view, to a view's
/// lane or to a lane's connection, and (but for a view's) to a replicate.
typedef struct ClrayBlock {
  u64 offset;  // of its first row, in `sums` or `counts`
  u32 width;   // numbers a row
  u32 padding;
} ClrayBlock;

/// A detector of a pass.
typedef struct ClrayDetector {
  u32 first_block;  // its first block in `blocks`: in the order of its row's sums
  u32 settings;     // offset in `settings` of the numbers it works with
} ClrayDetector;

/// What is constant over a pass.
typedef struct ClrayPass {
  f64 reference[3];     // reference point of delay and torque
  f64 unit_scale;       // 2^S for shares of energy and momentum
  f64 inv_lever_per_m;  // power of two that brings lever arms below 1
  u32 key0, key1;       // the seed
  u32 epoch;            // 0 search or plain, 1 confirmation
  u32 replicates;
  u32 views;
  u32 max_bounces;
  u32 width, height;   // pixels
  u32 materials;       // columns of the material table
  u32 finest;          // packets are no wider than 1/finest of the beam's rectangle: as wide as some faces
  u32 unsolved_words;  // of `unsolved` in a view
  u32 padding;
} ClrayPass;

// Shares of energy and momentum are below this on a first bounce; larger ones go to the second accumulator.
#define CLRAY_UNIT_LIMIT 4.0
#define CLRAY_UNIT_BITS 36  // 62 - 24 - log2(CLRAY_UNIT_LIMIT)

// Counters (64-bit), in this order.
#define CLRAY_COUNT_NON_FINITE 0
#define CLRAY_COUNT_STACK 1
#define CLRAY_COUNT_LOST 2
#define CLRAY_COUNT_OVERFLOW 3
#define CLRAY_COUNT_STARTED 4
#define CLRAY_COUNT_ESCAPED 5
#define CLRAY_COUNT_KILLED 6
#define CLRAY_COUNT_CAPPED 7
#define CLRAY_COUNTERS 8

/// A triangle as the beam of one view sees it, for exact passes (exact/leaf.cl). x and y lie across the beam, depth
/// toward the source, m.
typedef struct ClrayFace {
  f64 x[3], y[3];        // corners, counter-clockwise
  f64 path[3];           // path length by way of the corners, from that of the first
  f64 path_x, path_y;    // its slope over the face
  f64 depth0;            // of the first corner
  f64 slope_x, slope_y;  // of depth over the face
  f64 body[9];           // the corners in the body frame, from the body's centre
  f64 normal[3];         // unit, toward the source
  f64 offset;            // normal·x on the face's plane
  f64 box[4];            // least and greatest x, least and greatest y
  f64 nearest;           // greatest depth
  f64 margin;            // of depth: what is nearer than the face's own depth less this may hide it
  // Powers of two: integers per m² of the sums, and what brings x, y and path (from the first corner) below 1.
  f64 area_scale, inv_length, inv_path;
  f64 path_m;     // path length by way of the first corner, relative to the reference point
  f64 bin_scale;  // integers per m² of weight 1 in the bins of its view
  u32 view;
  u32 order;    // of faces in one place the first hides the others
  u32 carried;  // 1: its lit pieces are wanted by observers elsewhere
  u32 padding;
} ClrayFace;

// Sums of a face, as integers: area, first moments about its first corner, moments of path length from that corner, a
// bound of the area that rounding may have moved, and the number of visible pieces.
#define CLRAY_FACE_AREA 0
#define CLRAY_FACE_X 1
#define CLRAY_FACE_Y 2
#define CLRAY_FACE_PATH 3
#define CLRAY_FACE_PATH2 4
#define CLRAY_FACE_LOST 5
#define CLRAY_FACE_PIECES 6
#define CLRAY_FACE_SUMS 7

/// A face in a tile, with what is asked of it first.
typedef struct ClrayListed {
  f64 box[4];   // as in ClrayFace
  f64 nearest;  // as in ClrayFace
  u32 face;
  u32 padding;
} ClrayListed;

/// A tile of the beam of a view, and the faces in it: `count` of the list from `first` on, the largest first.
typedef struct ClrayTile {
  f64 x0, x1, y0, y1;
  f64 size;    // of the beam
  f64 margin;  // distances within it are zero
  u32 first, count;
} ClrayTile;

#define CLRAY_PIECE_CORNERS 7

/// A lit piece of a face, across the beam of a view.
typedef struct ClrayPiece {
  f64 x[CLRAY_PIECE_CORNERS], y[CLRAY_PIECE_CORNERS];
  f64 off;  // what its corners may be off, m
  u32 face, corners;
} ClrayPiece;

/// A face of one beam in another, of the light or of an observer: a step of (1, 0) across the first, by way of the
/// face, is one of (xx, yx) across the other, and a step of (0, 1) one of (xy, yy).
typedef struct ClrayCarried {
  f64 xx, xy, yx, yy;
  u32 there;  // its number in the other beam, or CLRAY_NOT_THERE
  u32 padding;
} ClrayCarried;

#define CLRAY_NOT_THERE 0xffffffffu

/// The window of a delay detector: `bins` bins from the path length first_m on. Its rows of bins begin at `offset`.
typedef struct ClrayBinning {
  f64 first_m, per_metre;
  u64 offset;
  u64 bins;
} ClrayBinning;

/// How the tiles of a view that are not solved are sampled, a point of each replicate in each.
typedef struct ClraySampling {
  f64 path_middle_m, inv_path_per_m;  // as in ClrayView
  u32 key0, key1, epoch, round;       // of the random numbers
  u32 replicates;
  u32 adds;       // 1: points add to the sums; 0: what they bring is only noted, to find out where tiles are to be cut
  u32 elsewhere;  // 1: the observer is not at the source: what is seen may be in shadow
  u32 padding;
} ClraySampling;

// Sizes, asserted in C++ here and on the device by the start-up self-test.
#define CLRAY_SIZES(X)   \
  X(ClrayMaterial, 120)  \
  X(ClrayPrimitive, 32)  \
  X(ClrayNode, 112)      \
  X(ClrayInstance, 136)  \
  X(ClrayView, 192)      \
  X(ClrayStratum, 16)    \
  X(ClrayConnection, 48) \
  X(ClrayBlock, 16)      \
  X(ClrayDetector, 8)    \
  X(ClrayPass, 88)       \
  X(ClrayFace, 320)      \
  X(ClrayListed, 48)     \
  X(ClrayTile, 56)       \
  X(ClrayPiece, 128)     \
  X(ClrayCarried, 40)    \
  X(ClraySampling, 48)   \
  X(ClrayBinning, 32)
#ifdef __cplusplus
#define CLRAY_ASSERT_SIZE(type, size) static_assert(sizeof(type) == size, "abi.h: " #type);
CLRAY_SIZES(CLRAY_ASSERT_SIZE)
#undef CLRAY_ASSERT_SIZE
#endif

#endif
