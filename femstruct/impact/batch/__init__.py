"""Many runs of one scene: what varies, one kernel, a row of numbers each."""
