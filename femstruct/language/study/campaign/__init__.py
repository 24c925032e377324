"""What a campaign varies and optimises, as it is written."""
