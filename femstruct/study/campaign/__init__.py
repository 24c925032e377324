"""What a campaign varies, the rows that came of it, and what they tell of a number."""
