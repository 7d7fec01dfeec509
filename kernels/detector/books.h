// SPDX-License-Identifier: Apache-2.0
// The energy books of a lane, as shares of the beam (see EnergyBooks in result.hpp): their places in a row of sums.
#ifndef CLRAY_DETECTOR_BOOKS_H
#define CLRAY_DETECTOR_BOOKS_H

#define CLRAY_BOOK_INCIDENT 0
#define CLRAY_BOOK_REFLECTED 1
#define CLRAY_BOOK_ABSORBED 2
#define CLRAY_BOOK_ROULETTE 3
#define CLRAY_BOOK_TRUNCATED 4
#define CLRAY_BOOK_UNCONNECTED 5
#define CLRAY_BOOKS 6

#endif
