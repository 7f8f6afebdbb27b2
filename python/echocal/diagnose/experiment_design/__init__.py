"""What the members of a credible set predict, and the measurements that separate them."""
