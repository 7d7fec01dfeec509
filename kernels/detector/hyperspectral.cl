// SPDX-License-Identifier: Apache-2.0
// hyperspectral: radiance per pixel and lane, summed by stage_record (stage/record.cl); it adds nothing of its own.
