"""Studies of studies: what varies, the samples made of it, running them on all cores, and the rows that come of it."""
