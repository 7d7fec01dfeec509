// SPDX-License-Identifier: Apache-2.0
// spectrometer: intensity per band. Its numbers are the totals that every beam pass keeps per lane (stage/record.cl);
// it adds nothing of its own.
