"""What the page of a study is made of: its style, its tables of inputs and cases, its pictures by kind."""
